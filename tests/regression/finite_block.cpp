// What docs/contact.md says of a block with ends beside what is exact: how much the average volume gradient slows it down, how a
// high one rocks, and what the widest gap changes for spheres. The numbers are the program's own: they show what has changed.
// The closed form is held in tests/verification/finite_block.cpp.

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "verification/finite_block.hpp"
#include "verification/shipped.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::finite_block;

// Why the widest gap is there: the average volume gradient tilts at the block's ends and takes a share of the sliding speed in every
// step: 43 % at courant 0.3.
TEST_CASE("with the average volume gradient the same block is slowed down, the more the shorter the step",
          "[friction][finite]") {
  const std::string average = set("/contact/normal", "average_volume_gradient");
  const double longer = slide(0, 0, {average}).acceleration,
               shorter = slide(0, 0, {average, set("/solver/courant", "0.1")}).acceleration;
  CHECK(longer < 0.75 * exact(0));
  CHECK(shorter < 0.8 * longer);
}

// What friction does to a soft block that is half as high as it is long.
TEST_CASE("a high block close to sticking rocks, whatever the step and the cells", "[friction][finite]") {
  for (const std::vector<std::string>& finer : refinements) {
    const auto [early, late] = rock(finer);
    INFO((finer.empty() ? "" : finer[0]) << ": " << early.most - early.least << " and " << late.most - late.least
                                         << " N");
    CHECK(late.most - late.least > 1.5 * (early.most - early.least));
  }
}

TEST_CASE("a block a quarter as high as it is long swings by less of what presses it than one half as high",
          "[friction][finite]") {
  const Pressed high = rock({}).late, low = rock({"/bodies/1/geometry/of/upper=[0.4, 0.1]"}).late;
  const double swing_of_high = (high.most - high.least) / high.pressing,
               swing_of_low = (low.most - low.least) / low.pressing;
  CHECK(swing_of_low < 2. / 3 * swing_of_high);
}

// The normal of curved bodies was not what was wrong, and changes little.
TEST_CASE("the widest gap changes the peak force of two spheres by less than four per cent", "[friction][finite]") {
  for (const std::string place : {"1.025", "1.0421875"}) {
    const auto peak = [&](const std::string& normal) {
      ShippedScene scene("studies/hertz_spheres.json",
                         {set("/contact/normal", normal), "/bodies/0/geometry/of/0/centre/1=-" + place,
                          "/bodies/1/geometry/of/0/centre/1=" + place});
      double force = 0;
      scene.run([&] { force = larger(force, std::abs(scene.simulation.backend().contact_record().force[1])); });
      return force;
    };
    CHECK(peak("widest_gap") == Approx(peak("average_volume_gradient")).epsilon(0.04));
  }
}
