// Single pairs that adhere, by hand: an ellipse of strengths, a weld inside it, friction or nothing beyond.

#include <limits>

#include "contacts/adhesion/adhesion.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;

/// Strengths of 4 Pa and 10 Pa; bodies that have parted rub with 0.5, and hold up to a fifth of a cell of 0.1 m.
constexpr Adhesion::Parameters glue{4, 10, 0.5, 0.2};

/// Body a, 2 kg, and body b, 6 kg, whose reduced mass is 1.5 kg: a moves beside b with (3, along, 0) m/s, y is the normal.
ContactPair<3, double> pair_of(double along, const Vec<3, double>& traction, double separation = 0) {
  ContactPair<3, double> pair{};
  pair.mass_a = 2, pair.mass_b = 6;
  pair.normal = {{0, 1, 0}};
  pair.momentum_a = {{2 * 3.5, 2 * along, 0}}, pair.momentum_b = {{6 * 0.5, 0, 0}};
  pair.separation = separation, pair.area = 0.2, pair.dt = 0.01, pair.cell_size = 0.1;
  pair.traction = traction;
  return pair;
}

ContactResult<3, double> result(const ContactPair<3, double>& pair) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();  // what the law leaves out is no number
  ContactResult<3, double> found{{{nothing, nothing, nothing}}, nothing, nothing, 0, {}};
  Adhesion::apply(glue, pair, found);
  return found;
}

void check(const ContactResult<3, double>& found, double along_x, double along_y, double heat, double status) {
  CHECK(found.impulse[0] == Approx(along_x));
  CHECK(found.impulse[1] == Approx(along_y));
  CHECK(found.impulse[2] == 0);
  CHECK(found.dissipated == Approx(heat));
  CHECK(found.status == status);
}

}  // namespace

TEST_CASE("inside the ellipse of strengths a pair moves as one, whether it parts, presses or slides", "[adhesion]") {
  for (const double along : {-2.0, 0.0, 2.0}) {
    check(result(pair_of(along, {{0, 0, 0}})), -1.5 * 3, -1.5 * along, 0, 1);
    check(result(pair_of(along, {{0, 3.9, 0}})), -1.5 * 3, -1.5 * along, 0, 1);
    check(result(pair_of(along, {{0, -1e6, 9.9}})), -1.5 * 3, -1.5 * along, 0, 1);  // pressure parts nothing
    check(result(pair_of(along, {{-0.59 * 10, 0.79 * 4, 0}})), -1.5 * 3, -1.5 * along, 0, 1);
  }
}

TEST_CASE("beyond the ellipse a pair that parts is let go, and one that presses rubs", "[adhesion]") {
  for (const Vec<3, double>& traction : {Vec<3, double>{{0, 4.1, 0}}, Vec<3, double>{{10.1, 0, 0}},
                                         Vec<3, double>{{0.61 * 10, 0.81 * 4, 0}}, Vec<3, double>{{7.2, -9, 7.2}}}) {
    check(result(pair_of(-2, traction)), 0, 0, 0, 0);
    // By Coulomb: a normal impulse of 1.5 * 2, half of it along the slide, its work at the mean speed (3 + 2) / 2.
    check(result(pair_of(2, traction)), -0.5 * 1.5 * 2, -1.5 * 2, 0.5 * 1.5 * 2 * 2.5, 2);
    check(result(pair_of(8, traction)), -1.5 * 3, -1.5 * 8, 0, 1);  // friction that is high enough stops it
    check(result(pair_of(2, traction, 1e-9)), 0, 0, 0, 0);
  }
}

TEST_CASE("nothing holds before the forces, where bodies that press rub", "[adhesion]") {
  for (const double along : {-2.0, 2.0}) {
    ContactPair<3, double> pair = pair_of(along, {{0, 1, 0}});
    pair.after_forces = false;
    if (along < 0)
      check(result(pair), 0, 0, 0, 0);
    else
      check(result(pair), -0.5 * 1.5 * 2, -1.5 * 2, 0.5 * 1.5 * 2 * 2.5, 2);
  }
}

TEST_CASE("a pair holds up to its reach", "[adhesion]") {
  check(result(pair_of(-2, {{0, 1, 0}}, 0.0199)), -1.5 * 3, 1.5 * 2, 0, 1);
  check(result(pair_of(-2, {{0, 1, 0}}, 0.0201)), 0, 0, 0, 0);
  check(result(pair_of(2, {{0, 1, 0}}, 0.0201)), 0, 0, 0, 0);
}

TEST_CASE("adhesion says that it pulls, reads tractions and acts over time", "[adhesion]") {
  CHECK(Adhesion::traits == (MPM_PULLS | MPM_READS_TRACTION | MPM_ACTS_OVER_TIME));
}
