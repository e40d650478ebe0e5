// What docs/contact.md says of two cylinders that are pressed together: numbers of the program's own, which show what has
// changed. How near their stress comes to that of Hertz is in tests/verification/hertz.cpp.

#include "verification/hertz.hpp"
#include "support/catch.hpp"
#include "support/page.hpp"

namespace mpm::test::hertz {

TEST_CASE("two cylinders press as the page on contact says", "[hertz][contact][docs]") {
  const Pressed found = press({});
  const double cell = 0.136, b = found.half_width;
  const auto printed = Page("docs/contact.md")
                           .read(
                               "together (E = 200 Pa, ν = 0.3) by # N/m with rows 34 mm apart, a contact of # cells "
                               "half-width and a sag of # mm");
  CHECK(found.force == printed[0].rounded());
  CHECK(b / cell == printed[1].rounded());
  CHECK(1000 * b * b / (2 * 8) == printed[2].rounded());
}

}  // namespace mpm::test::hertz
