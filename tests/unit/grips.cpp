// The sums of what grips give their particles, by hand.

#include "simulation/grips.hpp"

#include "support/catch.hpp"

using namespace mpm;

TEST_CASE("what a grip gives is the change of a particle's momentum, its moment and the change of its kinetic energy",
          "[grips]") {
  // 2 kg at (1, -2, 3) m come from (1, 2, -1) to (4, -2, 2) m/s: 2 (3, -4, 3) kg m/s, and 2 (24 - 6) / 2 = 18 J.
  GivenToGripped given;
  given.add(2, {1, -2, 3}, {1, 2, -1}, {4, -2, 2});
  CHECK(given.impulse == Vector3{6, -8, 6});
  CHECK(given.moment == Vector3{12, 12, 4});
  CHECK(given.energy == 18);
  SECTION("what is given to several particles adds up") {
    given.add(0.5, {0, 1, 0}, {0, 0, 0}, {2, 0, 0});
    CHECK(given.impulse == Vector3{7, -8, 6});
    CHECK(given.moment == Vector3{12, 12, 3});
    CHECK(given.energy == 19);
  }
  SECTION("sums of parts add up") {
    GivenToGripped other;
    other.add(0.5, {0, 1, 0}, {0, 0, 0}, {2, 0, 0});
    given.add(other);
    CHECK(given.impulse == Vector3{7, -8, 6});
    CHECK(given.moment == Vector3{12, 12, 3});
    CHECK(given.energy == 19);
  }
}
