// How much a wide opening softens a compliant layer, and what averaged gradients take of free planks' bend: numbers of
// docs/contact.md. They are the program's own, and show what has changed; the closed forms are in
// tests/verification/interfaces.cpp.

#include "verification/interfaces.hpp"
#include "support/catch.hpp"
#include "support/page.hpp"

namespace mpm::test::interfaces {

TEST_CASE("an opening that is wide beside a cell softens a layer by what the page on contact says",
          "[interface][docs]") {
  const auto printed = Page("docs/contact.md").read("and the layer softens: by # % in ω at # % of a cell");
  const double frequency = opening(0.01).frequency, opened = printed[1].value / 100 * 0.05;
  // Each bar's face swings by its speed over the frequency.
  const double wide = slowness(opening(0.01, opened * frequency / 2), {}), narrow = slowness(opening(0.01), {});
  std::printf("Layer opened by %g m: slower by %.5f\n", opened, wide - narrow);
  CHECK(100 * (wide - narrow) == printed[0].rounded());
}

TEST_CASE("with averaged gradients for normals free planks bend too little, by what the page on contact says",
          "[interface][docs]") {
  const double tip =
      probed(lower_plank({set("/contact/shear_stiffness", "0"), set("/contact/normal", "average_volume_gradient")}));
  CHECK(100 * (1 - tip / exact_tip(0)) ==
        Page("docs/contact.md").read("planks bend # % too little on the same cells").front().rounded());
}

}  // namespace mpm::test::interfaces
