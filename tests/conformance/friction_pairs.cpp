// Friction of single pairs, by hand: reduced mass m = m_a m_b/(m_a + m_b), normal impulse m u_n, friction
// min(m u_t, mu m u_n), heat by friction (Bardenhagen, Brackbill & Sulsky 2000): friction times the mean sliding speed.

#include <cmath>
#include <limits>

#include "contacts/coulomb/coulomb.hpp"
#include "contacts/frictionless/frictionless.hpp"
#include "contacts/stick/stick.hpp"
#include "contacts/velocity_dependent_friction/velocity_dependent_friction.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;

/// Body a, 2 kg, hits body b, 6 kg, which rests: m = 1.5 kg. It approaches by 4 m/s and slides by 3 m/s, so that it
/// sticks from a friction of 3/4 on.
ContactPair<3, double> hit(double separation) {
  ContactPair<3, double> pair{};
  pair.mass_a = 2, pair.mass_b = 6;
  pair.normal = {{0, 1, 0}};
  pair.momentum_a = {{2 * 1.8, 2 * 4.0, 2 * 2.4}}, pair.momentum_b = {{0, 0, 0}};
  pair.separation = separation;
  return pair;
}

ContactResult<3, double> result(const Coulomb::Parameters& p, double separation = -0.01) {
  ContactResult<3, double> found{};
  Coulomb::apply(p, hit(separation), found);
  return found;
}

void check_result(const ContactResult<3, double>& found, double normal, double friction, double heat, int status) {
  CHECK(std::abs(found.impulse[0] + 0.6 * friction) <= 1e-14);
  CHECK(std::abs(found.impulse[1] + normal) <= 1e-14);
  CHECK(std::abs(found.impulse[2] + 0.8 * friction) <= 1e-14);
  CHECK(std::abs(found.dissipated - heat) <= 1e-14);
  CHECK(found.status == status);
}

}  // namespace

TEST_CASE("a pair that slides takes the kinetic friction and makes heat of its work") {
  // mu = 1/4: normal 6 N s, friction 1.5 N s, sliding from 3 m/s to 2 m/s: heat 1.5 x 2.5 J.
  check_result(result({0.25, 0}), 6, 1.5, 3.75, 2);
  // mu = 1/2: friction 3 N s, from 3 m/s to 1 m/s: heat 3 x 2 J.
  check_result(result({0.5, 0}), 6, 3, 6, 2);
  check_result(result({0, 0}), 6, 0, 0, 2);
}

TEST_CASE("a pair sticks up to the larger coefficient of friction") {
  check_result(result({0.8, 0}), 6, 4.5, 0, 1);
  check_result(result({0.25, 0.8}), 6, 4.5, 0, 1);
  check_result(result({0.25, 0.7}), 6, 1.5, 3.75, 2);  // it slides with the kinetic one
}

TEST_CASE("a pair that is apart or parts is left alone") {
  check_result(result({0.25, 0}, 0.01), 0, 0, 0, 0);
  check_result(result({0.25, 0}, 0), 6, 1.5, 3.75, 2);
  ContactPair<3, double> parting = hit(-0.01);
  parting.momentum_a[1] = -8;
  ContactResult<3, double> found{};
  Coulomb::apply({0.25, 0}, parting, found);
  check_result(found, 0, 0, 0, 0);
}

TEST_CASE("a pair without friction presses and slides on") {
  ContactResult<3, double> found{};
  Frictionless::apply({}, hit(-0.01), found);
  check_result(found, 6, 0, 0, 2);
  Frictionless::apply({}, hit(0.01), found);
  check_result(found, 0, 0, 0, 0);
}

// The pair approaches by u = 4 m/s and slides by 3 m/s: v + mu(v) u = 3 for the speed v that is left.
TEST_CASE("a pair takes the friction of the speed that it is left with") {
  const auto check = [](double kinetic, double at_rest, double decay) {
    INFO(kinetic << " " << at_rest << " " << decay);
    ContactResult<3, double> found{};
    VelocityDependentFriction::apply({kinetic, at_rest, decay}, hit(-0.01), found);
    const double friction = std::hypot(found.impulse[0], found.impulse[2]), left = 3 - friction / 1.5;
    const double mu = kinetic + (at_rest - kinetic) * std::exp(-left / decay);
    CHECK(left + mu * 4 == Approx(3).epsilon(1e-12));
    CHECK(left > 0);
    CHECK(found.impulse[1] == Approx(-6).epsilon(1e-14));
    CHECK(found.dissipated == Approx(friction * (3 + left) / 2).epsilon(1e-12));
    CHECK(found.status == 2);
  };
  for (const double decay : {0.1, 0.5, 2.0, 50.0}) {
    check(0.1, 0.5, decay);  // it falls
    check(0.5, 0.1, decay);  // it rises
  }
  check(0.5, 0.1, 1e-12);  // the least decay speed
  check(0.1, 0.5, 1e-12);
  check(2, 0.1, 5);  // friction that would hold it at high speed slows it all the same
  // mu_s u = 3.2 m/s holds it, 2.8 m/s does not.
  ContactResult<3, double> found{};
  VelocityDependentFriction::apply({0.1, 0.8, 1}, hit(-0.01), found);
  check_result(found, 6, 4.5, 0, 1);
  VelocityDependentFriction::apply({0.1, 0.7, 1}, hit(-0.01), found);
  CHECK(found.status == 2);
  VelocityDependentFriction::apply({0.1, 0.8, 1}, hit(0.01), found);
  check_result(found, 0, 0, 0, 0);
  // With a long decay it is Coulomb's of the static coefficient, with a short one that of the kinetic.
  VelocityDependentFriction::apply({0.1, 0.25, 1e12}, hit(-0.01), found);
  CHECK(found.dissipated == Approx(3.75).epsilon(1e-10));
  VelocityDependentFriction::apply({0.25, 0.7, 1e-6}, hit(-0.01), found);
  CHECK(found.dissipated == Approx(3.75).epsilon(1e-10));
}

// In float the least decay speed keeps all numbers finite, of pairs that are apart too.
TEST_CASE("friction of the least decay speed is a number in float") {
  ContactPair<2, float> pair{};
  pair.mass_a = 2, pair.mass_b = 6;
  pair.normal = {{0, 1}};
  pair.momentum_a = {{6, 8}};
  for (const float separation : {-0.01f, 0.01f})
    for (const double kinetic : {0.1, 0.5, 100.0}) {
      pair.separation = separation;
      ContactResult<2, float> found{};
      VelocityDependentFriction::apply({kinetic, 0.3, 1e-12}, pair, found);
      INFO(separation << " " << kinetic);
      CHECK(std::isfinite(found.impulse[0]));
      CHECK(std::isfinite(found.dissipated));
      CHECK((found.impulse[1] == 0) == (separation > 0));
    }
}

// At the brink of sticking and with a slope of the law that is nearly its own reciprocal Newton's rounds do not arrive: what
// they leave is friction below that of the speed that is left, never above, and heat that is never negative.
TEST_CASE("a pair at the brink is slowed by no more than its law allows") {
  for (int k = 1; k <= 40; ++k) {
    const double at_rest = 0.75 - 0.01 * std::pow(0.5, k), decay = 4 * (at_rest - 0.1) * (1 + 0.01 * k);
    ContactResult<3, double> found{};
    VelocityDependentFriction::apply({0.1, at_rest, decay}, hit(-0.01), found);
    const double friction = std::hypot(found.impulse[0], found.impulse[2]), left = 3 - friction / 1.5;
    INFO(at_rest << " " << decay << " left " << left);
    CHECK(left > 0);
    CHECK(friction / 6 <= 0.1 + (at_rest - 0.1) * std::exp(-left / decay) + 1e-12);
    CHECK(friction / 6 <= at_rest);
    CHECK(found.dissipated > 0);
  }
}

// Where friction falls with the speed, what the rounds find roots of is, in decay speeds and but for a shift of v, the
// function y + exp(-y) - 1 less a constant b >= 0. Newton's method on it from above comes nearest to failing with b = 0, where
// the first round ends below 1 and each other one halves y at least: after eight y^2 / 2 is below 2^-15. Here the pair is
// within a few millionths of b = 0, with speeds of a few m/s and of thousands.
TEST_CASE("eight rounds leave a pair within 2^-15 of the decay speed of the friction of its law") {
  for (const double scale : {1.0, 1000.0})
    for (const double steepness : {0.999, 1.0, 1.0001}) {
      const double kinetic = 0.7, at_rest = 0.75 * (1 - 1e-7), decay = (at_rest - kinetic) * 4 * scale / steepness;
      ContactPair<3, double> pair = hit(-0.01);
      for (int i = 0; i < 3; ++i) pair.momentum_a[i] *= scale;
      ContactResult<3, double> found{};
      VelocityDependentFriction::apply({kinetic, at_rest, decay}, pair, found);
      const double lost = std::hypot(found.impulse[0], found.impulse[2]) / 1.5, left = 3 * scale - lost;
      const double wanted = (kinetic + (at_rest - kinetic) * std::exp(-left / decay)) * 4 * scale;
      INFO(scale << " " << steepness << " left " << left << " decay " << decay);
      CHECK(found.status == 2);
      CHECK(lost <= wanted + 1e-12 * scale);
      CHECK(lost >= wanted - decay * 0x1p-15);
    }
}

// A rigid body that moves as it is told takes any impulse: body a, 2 kg, loses its approach of 4 m/s, 8 N s, and by
// friction of 1/4 a third of its sliding of 3 m/s, 2 N s, which makes 2 x 2.5 J of heat.
TEST_CASE("beside an infinite mass a pair has the mass of its other body") {
  ContactPair<3, double> pair = hit(-0.01);
  pair.mass_b = std::numeric_limits<double>::infinity();
  ContactResult<3, double> found{};
  Coulomb::apply({0.25, 0}, pair, found);
  check_result(found, 8, 2, 5, 2);
  Frictionless::apply({}, pair, found);
  check_result(found, 8, 0, 0, 2);
  VelocityDependentFriction::apply({0.25, 0.25, 1}, pair, found);
  check_result(found, 8, 2, 5, 2);
  Stick::apply({}, pair, found);
  check_result(found, 8, 6, 0, 1);
}

// An observer who moves sees the same impulse and heat.
TEST_CASE("two bodies that both move meet by their relative velocity") {
  ContactPair<3, double> pair = hit(-0.01);
  for (int i = 0; i < 3; ++i) pair.momentum_a[i] += 2 * (i - 2), pair.momentum_b[i] += 6 * (i - 2);
  ContactResult<3, double> found{};
  Coulomb::apply({0.25, 0}, pair, found);
  check_result(found, 6, 1.5, 3.75, 2);
  Stick::apply({}, pair, found);
  check_result(found, 6, 4.5, 0, 1);
}

// The product of two masses of 1e20 kg is beyond the largest number in float.
TEST_CASE("masses whose product overflows in float meet") {
  ContactPair<2, float> pair{};
  pair.mass_a = 1e20f, pair.mass_b = 1e20f;
  pair.normal = {{0, 1}};
  pair.momentum_a = {{3e20f, 4e20f}};
  pair.separation = -0.01f;
  ContactResult<2, float> found{};
  Coulomb::apply({0.25, 0}, pair, found);
  CHECK(found.impulse[0] / 1e20f == Approx(-0.5));
  CHECK(found.impulse[1] / 1e20f == Approx(-2));
  Stick::apply({}, pair, found);
  CHECK(found.impulse[0] / 1e20f == Approx(-1.5));
}
