// Single pairs joined by springs or by a liquid, against the closed forms of the oscillator m d'' + k d = 0, a sinusoid of
// w^2 = k / m, and of m v' = -c v, v exp(-c t / m).

#include <algorithm>
#include <cmath>
#include <limits>

#include "contacts/bilinear_interface/bilinear_interface.hpp"
#include "contacts/linear_interface/linear_interface.hpp"
#include "contacts/liquid_contact/liquid_contact.hpp"
#include "contacts/stick/stick.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;

constexpr double mass = 1.5, area = 0.2;

/// Body a, 2 kg, and body b, 6 kg, whose reduced mass is 1.5 kg: b moves beside a with (-1.8, -4, -2.4) m/s, -4 along the
/// normal, and has moved by (0.003, opening, 0.004) m.
ContactPair<3, double> pair_of(double opening, double dt) {
  ContactPair<3, double> pair{};
  pair.mass_a = 2, pair.mass_b = 6;
  pair.normal = {{0, 1, 0}};
  pair.momentum_a = {{2 * 1.8, 2 * 4.0, 2 * 2.4}}, pair.momentum_b = {{0, 0, 0}};
  pair.separation = -0.01, pair.area = area, pair.dt = dt;
  pair.displacement = {{0.003, opening, 0.004}};
  return pair;
}

struct Kick {
  double impulse, stored;  ///< on a, kg m/s; J
};
/// The kick that keeps d on the sinusoid of the oscillator at steps in which d moves on with the new speed.
Kick kick(double stiffness, double displacement, double speed, double dt) {
  const double half_sine = std::sin(std::sqrt(stiffness * area / mass) * dt / 2);
  const double impulse = mass * 4 * half_sine * half_sine * displacement / dt;
  const double moved = displacement + (speed - impulse / mass) * dt;
  return {impulse, stiffness * area / 2 * (moved * moved - displacement * displacement)};
}

/// The stiffness with which the pair turns by `angle` in a step.
double stiffness_of(double angle, double dt) {
  return angle * angle * mass / (area * dt * dt);
}

template <class Law>
ContactResult<3, double> result(const typename Law::Parameters& p, const ContactPair<3, double>& pair) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();  // what a law leaves out is no number
  ContactResult<3, double> found{{{nothing, nothing, nothing}}, nothing, 0, nothing, {}};
  Law::apply(p, pair, found);
  return found;
}

void check_springs(const ContactResult<3, double>& found, double normal, double shear, double opening, double dt) {
  const Kick y = kick(normal, opening, -4, dt), x = kick(shear, 0.003, -1.8, dt), z = kick(shear, 0.004, -2.4, dt);
  const double size = std::abs(y.impulse) + std::abs(x.impulse) + std::abs(z.impulse) + 1e-300;
  CHECK(std::abs(found.impulse[0] - x.impulse) <= 1e-14 * size);
  CHECK(std::abs(found.impulse[1] - y.impulse) <= 1e-14 * size);
  CHECK(std::abs(found.impulse[2] - z.impulse) <= 1e-14 * size);
  CHECK(std::abs(found.stored - (x.stored + y.stored + z.stored)) <= 1e-13 * 5 * size);
  CHECK(found.dissipated == 0);
  CHECK(found.status == 2);
}

}  // namespace

// d_n = (d_1 sin(n theta) - d_0 sin((n - 1) theta)) / sin(theta): a sinusoid through the first two, for 1000 steps.
TEST_CASE("a pair joined by a spring stays on its sinusoid") {
  const double dt = 0.01;
  for (const double theta : {0.01, 0.3, 0.99}) {
    ContactPair<3, double> pair = pair_of(0, dt);
    double displacement = 0.02, speed = -0.5, first = 0, largest = 0;
    for (int n = 1; n <= 1000; ++n) {
      pair.displacement = {{0, displacement, 0}};
      pair.momentum_a = {{0, -2 * speed, 0}};
      speed -= result<LinearInterface>({stiffness_of(theta, dt), 0}, pair).impulse[1] / mass;
      displacement += speed * dt;
      if (n == 1) first = displacement;
      const double exact = (first * std::sin(n * theta) - 0.02 * std::sin((n - 1) * theta)) / std::sin(theta);
      largest = larger(largest, std::abs(displacement - exact));
    }
    INFO(theta);
    CHECK(largest < 1e-9);
  }
}

// A weld takes over between theta^2 = 1 and 2: nothing jumps.
TEST_CASE("a spring gives way to a weld without a jump") {
  const double dt = 0.01;
  double before = 0;
  for (int k = 0; k <= 200; ++k) {
    const double found =
        result<LinearInterface>({stiffness_of(std::sqrt(0.5 + 0.01 * k), dt), 0}, pair_of(0.005, dt)).impulse[1];
    if (k > 0) CHECK(std::abs(found - before) < 0.1);
    before = found;
  }
  CHECK(std::abs(before + mass * 4) <= 1e-13);
}

TEST_CASE("a pair joined by springs takes the kick of its mass, area and displacement") {
  const double dt = 0.01;
  for (const double normal : {0.05, 0.3, 0.999})
    for (const double shear : {0.02, 0.6, 0.999})
      for (const double opening : {0.005, -0.02}) {
        INFO(normal << " " << shear << " " << opening);
        const double D = stiffness_of(normal, dt), S = stiffness_of(shear, dt);
        check_springs(result<LinearInterface>({D, S}, pair_of(opening, dt)), D, S, opening, dt);
      }
  // Without stiffness across the normal nothing acts there, and without any nothing at all.
  const double D = stiffness_of(0.3, dt);
  check_springs(result<LinearInterface>({D, 0}, pair_of(0.005, dt)), D, 0, 0.005, dt);
  const ContactResult<3, double> free = result<LinearInterface>({0, 0}, pair_of(0.005, dt));
  for (int i = 0; i < 3; ++i) CHECK(free.impulse[i] == 0);
  CHECK(free.status == 0);
}

TEST_CASE("a spring that is far too stiff for the step holds its pair as a weld does, in both stages") {
  const double dt = 0.01, stiff = stiffness_of(1.42, dt), soft = stiffness_of(0.3, dt);
  ContactPair<3, double> pair = pair_of(0.005, dt);
  const ContactResult<3, double> weld = result<Stick>({}, pair);
  for (const bool after : {false, true}) {
    pair.after_forces = after;
    const ContactResult<3, double> held = result<LinearInterface>({stiff, stiff}, pair);
    for (int i = 0; i < 3; ++i) CHECK(std::abs(held.impulse[i] - weld.impulse[i]) <= 1e-14);
    CHECK(held.stored == 0);
    CHECK(held.status == 1);
    // One held along the normal alone slides on its springs, which act after the forces only.
    const ContactResult<3, double> half = result<LinearInterface>({stiff, soft}, pair);
    const double shear = after ? kick(soft, 0.003, -1.8, dt).impulse : 0;
    CHECK(std::abs(half.impulse[1] - weld.impulse[1]) <= 1e-14);
    CHECK(std::abs(half.impulse[0] - shear) <= 1e-14);
    CHECK(half.status == 2);
  }
  pair.after_forces = false;
  const ContactResult<3, double> before = result<LinearInterface>({soft, soft}, pair);
  for (int i = 0; i < 3; ++i) CHECK(before.impulse[i] == 0);
  CHECK(before.stored == 0);
  CHECK(before.status == 0);
}

// The pair closes by 4 m/s: with 0.02 s a layer that is open by less than 0.04 m is closed in the middle of the step.
TEST_CASE("a layer takes the stiffness of its opening in the middle of the step") {
  const double dt = 0.02, tension = stiffness_of(0.1, dt), compression = stiffness_of(0.5, dt),
               shear = stiffness_of(0.2, dt);
  for (const double opening : {0.05, 0.041, 0.039, 0.0, -0.03}) {
    INFO(opening);
    const double normal = opening > 0.04 ? tension : compression;
    check_springs(result<BilinearInterface>({tension, compression, shear}, pair_of(opening, dt)), normal, shear,
                  opening, dt);
  }
}

TEST_CASE("a liquid presses without pulling and slows sliding exponentially while it touches") {
  for (const double exponent : {1e-3, 0.5, 3.0, 8.0}) {
    INFO(exponent);
    const double dt = 0.01, b = 0.02, viscosity = exponent * mass * b / (area * dt);
    ContactPair<3, double> pair = pair_of(0, dt);
    const double share = -std::expm1(-exponent), speed = 3;
    const auto check = [&](double share_of_slide, double normal, double heat) {
      const ContactResult<3, double> found = result<LiquidContact>({viscosity, b}, pair);
      CHECK(std::abs(found.impulse[0] + mass * share_of_slide * 1.8) <= 1e-14);
      CHECK(std::abs(found.impulse[2] + mass * share_of_slide * 2.4) <= 1e-14);
      CHECK(std::abs(found.impulse[1] - normal) <= 1e-14);
      CHECK(std::abs(found.dissipated - heat) <= 1e-13);
    };
    const double heat = mass / 2 * speed * speed * -std::expm1(-2 * exponent);
    check(share, -mass * 4, heat);
    pair.after_forces = false;  // it drags once a step
    check(0, -mass * 4, 0);
    pair.after_forces = true, pair.momentum_a[1] = -8;  // it parts: it drags and does not pull
    check(share, 0, heat);
    pair.separation = 0.01;
    check(0, 0, 0);
  }
  // What would leave less than four millionths of the sliding holds it: exp(-12.8) is 2.8 millionths, exp(-12.4) 4.1.
  ContactPair<3, double> pair = pair_of(0, 0.01);
  const auto viscosity = [](double exponent) { return exponent * mass * 0.02 / (area * 0.01); };
  for (const double exponent : {12.8, 20.0, 1e6}) {
    const ContactResult<3, double> held = result<LiquidContact>({viscosity(exponent), 0.02}, pair);
    CHECK(held.status == 1);
    CHECK(std::abs(held.impulse[0] + mass * 1.8) <= 1e-14);
  }
  CHECK(result<LiquidContact>({viscosity(12.4), 0.02}, pair).status == 2);
  // One that hits the wall straight on has nothing to slide with and rests on it, however little of it would slip.
  pair.momentum_a = {{0, 2 * 4.0, 0}};
  const ContactResult<3, double> straight = result<LiquidContact>({viscosity(0.5), 0.02}, pair);
  CHECK(straight.status == 1);
  CHECK(straight.dissipated == 0);
  CHECK(std::abs(straight.impulse[1] + mass * 4) <= 1e-14);
}
