// The plane on which a solid cracks, in closed form: where it begins, how it turns with the body, what it is in 2-D and around
// an axis, and how fast waves are.

#include <cmath>
#include <random>

#include "kernel/dual.hpp"
#include "kernel/polar.hpp"
#include "materials/anisotropic_damage/anisotropic_damage.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;
using Mat2 = Mat<2, double>;
using Law = AnisotropicDamage;

/// Concrete: E = 30 GPa, ft = 3 MPa, Gc = 100 J/m^2, and along cracks 2 MPa and 60 J/m^2, on cells of 5 cm.
constexpr double young = 30e9, poisson = 0.2, strength = 3e6, onset = strength / young, width = 0.05;
constexpr double mu = young / (2 * (1 + poisson)), lambda = 2 * mu * poisson / (1 - 2 * poisson);
constexpr double modulus = lambda + 2 * mu;

Law::Parameters concrete(double nu = poisson) {
  return {young, nu, 2400, strength, 100, 0, 2e6, 60, 0, 1, width};
}

Mat3 transposed(const Mat3& a) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a(j, i);
  return r;
}
/// A turn about the axis that the two given ones do not hold.
Mat3 turn(double angle, int first = 0, int second = 1) {
  Mat3 r = Mat3::identity();
  r(first, first) = r(second, second) = std::cos(angle);
  r(second, first) = std::sin(angle), r(first, second) = -std::sin(angle);
  return r;
}
Mat3 diagonal(double x, double y, double z) {
  return {{x, 0, 0, 0, y, 0, 0, 0, z}};
}
Mat3 stretched(const Vec<3, double>& e) {
  return diagonal(std::exp(e[0]), std::exp(e[1]), std::exp(e[2]));
}
Mat3 inverse(const Mat3& a) {
  Mat3 r = transposed(polar::cofactor(a));
  for (double& entry : r.m) entry /= determinant(a);
  return r;
}
Law::State<3, double> whole() {
  return {Mat3::identity(), {}, 0, 0, 0, 0};
}
/// Goes on to the deformation gradient F, in one step. Returns the heat, J/m^3.
double deform_to(const Law::Constants<double>& c, Law::State<3, double>& state, const Mat3& F) {
  Mat3 L = F * inverse(state.deformation_gradient);
  for (int i = 0; i < 3; ++i) L(i, i) -= 1;
  return Law::advance(c, L, 1.0, state);
}
double largest_difference(const Sym<3, double>& a, const Mat3& b) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) worst = larger(worst, std::abs(a(i, j) - b(i, j)));
  return worst;
}
Mat3 full(const Sym<3, double>& a) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a(i, j);
  return r;
}

}  // namespace

TEST_CASE(
    "anisotropic damage: a crack begins where the largest principal stress is the strength, and never under pressure") {
  const Law::Constants<double> c(concrete());
  const auto cracked = [&](double x, double y, double z) {
    Law::State<3, double> state = whole();
    const double heat = deform_to(c, state, turn(0.4, 1, 2) * stretched({{x, y, z}}) * turn(0.3, 0, 2));
    CHECK((state.opening_strain > 0 ? heat > 0 && state.damage > 0 : heat == 0 && state.damage == 0));
    return state.opening_strain > 0;
  };
  CHECK(!cracked(-0.1, -0.1, -0.1));
  CHECK(!cracked(-0.1, 0, 0));
  CHECK(!cracked(-0.1, 0.9999 * poisson * 0.1, 0.9999 * poisson * 0.1));  // free sides
  CHECK(!cracked(-0.1, 0.01, -0.01));                                     // sheared under pressure
  const auto begins_at = [&](double x, double y, double z) {
    CAPTURE(x, y, z);
    CHECK(!cracked(0.9999 * x, 0.9999 * y, 0.9999 * z));
    CHECK(cracked(1.0001 * x, 1.0001 * y, 1.0001 * z));
    CHECK(!cracked(0.9999 * z, 0.9999 * x, 0.9999 * y));
    CHECK(cracked(1.0001 * z, 1.0001 * x, 1.0001 * y));
  };
  begins_at(onset, -poisson * onset, -poisson * onset);
  begins_at(strength / modulus, 0, 0);                      // confined at the sides
  begins_at(strength / (2 * mu), -strength / (2 * mu), 0);  // pure shear
  // Two stresses alike, and three.
  begins_at((1 - poisson) * onset, (1 - poisson) * onset, -2 * poisson * onset);
  const double evenly = strength / (3 * lambda + 2 * mu);
  begins_at(evenly, evenly, evenly);
}

TEST_CASE("anisotropic damage: the plane lies across the largest principal stress, in the body before it was turned") {
  const Law::Constants<double> c(concrete());
  const double angle = std::acos(-1.0) / 6, along = 3 * onset;
  for (const double turned : {0.0, 0.9, -2.0}) {
    // Stretched along the direction at 30 degrees to x in the plane of x and y.
    Law::State<3, double> state = whole();
    deform_to(c, state, turn(turned) * turn(angle) * stretched({{along, 0, 0}}) * turn(-angle));
    const double sign = state.crack_normal[0] < 0 ? -1 : 1;
    CHECK(sign * state.crack_normal[0] == Approx(std::sqrt(3.0) / 2).epsilon(1e-10));
    CHECK(sign * state.crack_normal[1] == Approx(0.5).epsilon(1e-10));
    CHECK(std::abs(state.crack_normal[2]) < 1e-12);
    // Linear softening sigma = slope (end - kappa), found from along = kappa - k sigma/E, k = 1 - E/M; (1 - d) M is left
    // where (1 - d)/(1 - k d) = sigma/(E kappa).
    const double end = 2 * 100 / (strength * width), k = 1 - young / modulus, slope = strength / (end - onset);
    const double kappa = (along + k / young * slope * end) / (1 + k / young * slope);
    const double left = slope * (end - kappa) / (young * kappa), damage = (1 - left) / (1 - k * left);
    const double stress = (1 - damage) * modulus * along, side = stress * poisson / (1 - poisson);
    const Mat3 expected = turn(turned + angle) * diagonal(stress, side, side) * turn(-turned - angle);
    CHECK(state.opening_strain == Approx(kappa).epsilon(1e-9));
    CHECK(largest_difference(Law::kirchhoff_stress(c, state), expected) < 1e-9 * strength);
  }
}

TEST_CASE(
    "anisotropic damage: a cracked body that is turned in steps has the turned stress, and its plane stays in it") {
  const Law::Constants<double> c(concrete());
  Law::State<3, double> state = whole();
  deform_to(c, state, turn(0.5) * stretched({{4 * onset, 0, 0}}) * turn(-0.5));
  // Sheared askew of the plane, so that tension, shear and the stress along the plane all are there.
  Mat3 F = turn(0.5) * stretched({{3 * onset, 2 * onset, -onset}}) * turn(-0.5);
  F(0, 1) += 2 * onset, F(2, 1) -= onset;
  deform_to(c, state, F);
  const Vec<3, double> normal = state.crack_normal;
  const Mat3 start = full(Law::kirchhoff_stress(c, state));
  const double energy = Law::stored_energy(c, state), speed = Law::wave_speed(c, state), damage = state.damage;
  CHECK(state.shear_damage > 0);
  Mat3 Q = Mat3::identity();
  for (int k = 1; k <= 12; ++k) {
    Q = turn(0.7, k % 3, (k + 1) % 3) * Q;
    CHECK(deform_to(c, state, Q * F) < 1e-9 * strength * onset);
    const Mat3 expected = Q * start * transposed(Q);
    CHECK(largest_difference(Law::kirchhoff_stress(c, state), expected) < 1e-9 * strength);
    CHECK(Law::stored_energy(c, state) == Approx(energy).epsilon(1e-9));
    CHECK(Law::wave_speed(c, state) == Approx(speed).epsilon(1e-9));
    CHECK(state.damage == Approx(damage).epsilon(1e-9));
    for (int i = 0; i < 3; ++i) CHECK(state.crack_normal[i] == normal[i]);
  }
}

TEST_CASE("anisotropic damage: energy is that of the whole strain less what the plane has lost, in any place") {
  // In the frame of space, with n = R n0 by the polar rotation and E = ln V by the principal directions of F F^T.
  std::mt19937 numbers(7);
  const auto entry = [&] { return std::ldexp(static_cast<double>(numbers()), -31) - 1; };
  const Law::Constants<double> c(concrete());
  for (int trial = 0; trial < 200; ++trial) {
    Law::State<3, double> state = whole();
    const Mat3 turned = turn(3 * entry(), 0, 1) * turn(3 * entry(), 1, 2);
    Vec<3, double> e{{0.3 * entry(), 0.3 * entry(), 0.3 * entry()}};
    const Mat3 R = turn(3 * entry(), 0, 2) * turn(3 * entry(), 1, 2);
    state.deformation_gradient = turned * stretched(e) * transposed(turned) * R;
    const Mat3 place = turn(3 * entry(), 0, 1) * turn(3 * entry(), 0, 2);
    Vec<3, double> n{};
    for (int i = 0; i < 3; ++i) state.crack_normal[i] = place(i, 0);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) n[i] += R(i, j) * state.crack_normal[j];
    state.opening_strain = 1, state.damage = 0.5 + 0.5 * entry(), state.shear_damage = 0.5 + 0.5 * entry();
    const Mat3 E = turned * diagonal(e[0], e[1], e[2]) * transposed(turned);
    double trace = 0, squares = 0, normal = 0, along = 0;
    for (int i = 0; i < 3; ++i) {
      double pull = 0;
      for (int j = 0; j < 3; ++j) pull += E(i, j) * n[j], squares += E(i, j) * E(i, j);
      trace += E(i, i), normal += n[i] * pull, along += pull * pull;
    }
    along -= normal * normal;
    const double stress = 2 * mu * normal + lambda * trace, pulled = std::max(stress, 0.0);
    const double energy = mu * squares + lambda / 2 * trace * trace - state.damage * pulled * pulled / (2 * modulus) -
                          state.shear_damage * 2 * mu * along;
    CAPTURE(trial);
    CHECK(Law::stored_energy(c, state) == Approx(energy).epsilon(1e-9));
    // Across the plane: (1 - d) of its normal stress where that pulls.
    const Mat3 tau = full(Law::kirchhoff_stress(c, state));
    double total = 0;
    for (int i = 0; i < 3; ++i) total += tau(i, i);
    const double kept = stress - state.damage * pulled;
    CHECK(total == Approx((3 * lambda + 2 * mu) * trace - (stress - kept) * (1 + 2 * poisson / (1 - poisson)))
                       .epsilon(1e-9)
                       .margin(1e-9 * modulus));
  }
}

TEST_CASE(
    "anisotropic damage: in the plane and around an axis it is the solid of three dimensions, cracks around it too") {
  const Law::Constants<double> c(concrete());
  const double pulls[][3] = {{4, -1, -0.5}, {-1, 3, 1}, {-0.5, -1, 5}, {0.5, 0.2, 2.5}};
  for (const auto& pull : pulls) {
    CAPTURE(pull[0], pull[1], pull[2]);
    const Mat3 F = turn(0.8) * stretched({{pull[0] * onset, pull[1] * onset, pull[2] * onset}}) * turn(-0.3);
    Law::State<3, double> space = whole();
    Law::AxisymmetricState<double> ring{Deformation<2, double>::identity(), {}, 0, 0, 0, 0};
    const auto both = [&](const Mat3& L) {
      const double heat = Law::advance(c, L, 1.0, space);
      const Deformation<2, double> gradient{{{L(0, 0), L(0, 1), L(1, 0), L(1, 1)}}, L(2, 2)};
      CHECK(Law::advance(c, gradient, 1.0, ring) == Approx(heat).epsilon(1e-9));
      const Sym<3, double> tau = Law::kirchhoff_stress(c, space);
      const Sym<2, double> flat = Law::kirchhoff_stress(c, ring);
      const double here[] = {flat(0, 0), flat(1, 1), flat.s[2], flat(0, 1)},
                   there[] = {tau(0, 0), tau(1, 1), tau(2, 2), tau(0, 1)};
      for (int k = 0; k < 4; ++k) CHECK(std::abs(here[k] - there[k]) < 1e-9 * strength);
      CHECK(Law::stored_energy(c, ring) == Approx(Law::stored_energy(c, space)).epsilon(1e-9));
      CHECK(Law::wave_speed(c, ring) == Approx(Law::wave_speed(c, space)).epsilon(1e-9));
      CHECK(ring.damage == Approx(space.damage).epsilon(1e-9));
    };
    Mat3 L = F;
    for (int i = 0; i < 3; ++i) L(i, i) -= 1;
    both(L);
    CHECK(space.damage > 0);
    const bool around = pull[2] > pull[0] && pull[2] > pull[1];
    CHECK(std::hypot(ring.crack_normal[0], ring.crack_normal[1]) == Approx(around ? 0 : 1).margin(1e-12));
    CHECK(std::abs(space.crack_normal[2]) == Approx(around ? 1 : 0).margin(1e-12));
    both({{2 * onset, onset, 0, -3 * onset, onset, 0, 0, 0, onset}});
    both({{-3 * onset, 2 * onset, 0, 0, -onset, 0, 0, 0, -9 * onset}});
  }
  // Of stresses alike in the plane and around the axis, as on the axis itself, the one in the plane cracks.
  Law::AxisymmetricState<double> axis{Deformation<2, double>::identity(), {}, 0, 0, 0, 0};
  Law::advance(c, Deformation<2, double>{{{4 * onset, 0, 0, 0}}, 4 * onset}, 1.0, axis);
  CHECK(std::hypot(axis.crack_normal[0], axis.crack_normal[1]) == Approx(1).epsilon(1e-9));
}

TEST_CASE("anisotropic damage: in single precision the curve is the same to the rounding of its strains") {
  const Law::Constants<float> c({1000, 0.3, 1000, 50, 1, 0, 40, 1.2, 0, 1, 0.1});
  Law::State<3, float> state{Mat<3, float>::identity(), {}, 0, 0, 0, 0};
  // ft/E = 0.05 and the end at 2 Gc/(ft b) = 0.4: half of the strength is left at 0.225, with sides of -nu ft/2/E.
  double heat = 0;
  const int steps = 64;
  for (int k = 0; k < steps; ++k) {
    Mat<3, float> L{};
    for (int i = 0; i < 3; ++i) L(i, i) = static_cast<float>(std::expm1((i ? -0.3 * 0.025 : 0.225) / steps));
    heat += static_cast<double>(Law::advance(c, L, 1.0F, state));
  }
  CHECK(Law::kirchhoff_stress(c, state)(0, 0) == Approx(25).epsilon(1e-4));
  CHECK(std::abs(Law::kirchhoff_stress(c, state)(1, 1)) < 0.01);
  CHECK(heat == Approx(10 - 25 * 0.4 / 2).epsilon(1e-4));
}

TEST_CASE("anisotropic damage: no rounding damages what stays below the strength") {
  for (int k = 0; k < 2000; ++k) {
    const double ft = strength * (0.5 + 1e-3 * k), law = k % 3;
    const Law::Constants<double> c({young, poisson, 2400, ft, 100, law, 2e6, 60, law, 1, 0.01});
    Law::State<3, double> state = whole();
    const double side = -poisson * 0.999 * ft / young;
    const double heat = deform_to(c, state, turn(0.1 * k, 0, 2) * stretched({{0.999 * ft / young, side, side}}));
    if (state.damage != 0 || state.shear_damage != 0 || state.sliding_strain != 0) FAIL("ft = " << ft);
    if (heat != 0) FAIL("ft = " << ft << ", heat " << heat);
  }
}

TEST_CASE(
    "anisotropic damage: the fastest wave is that of Hencky's solid until it cracks, and none is faster afterwards") {
  const Law::Constants<double> c(concrete());
  const auto reported = [&](const Law::Constants<double>& constants, const Law::State<3, double>& state) {
    const double speed = Law::wave_speed(constants, state);
    return 2400 * speed * speed;
  };
  const auto askew = [](double x) { return x * x / (2 * (1 + x)); };
  Law::State<3, double> state = whole();
  CHECK(reported(c, state) == Approx(modulus).epsilon(1e-12));
  state.deformation_gradient = stretched({{-0.3, 0.06, 0.06}});  // the least stress is -0.3 E
  CHECK(reported(c, state) == Approx(modulus + 0.3 * young + mu * askew(0.36)).epsilon(1e-9));
  state.deformation_gradient = stretched({{3, 0, 1}});
  CHECK(reported(c, state) == Approx(mu * (3 + std::sqrt(10.0) + askew(3))).epsilon(1e-9));
  // Open along x: without its tension 0.4 M the sides, pulled there by 0.4 lambda, press with lambda (-0.2) - 2 mu 0.1 less
  // lambda/M of lambda (-0.2).
  state.crack_normal = {{1, 0, 0}}, state.opening_strain = 1, state.damage = 1, state.shear_damage = 1;
  state.deformation_gradient = stretched({{0.4, -0.1, -0.1}});
  const double pull = modulus * 0.4 - lambda * 0.2, sides = lambda * 0.2 - 2 * mu * 0.1;
  CHECK(reported(c, state) == Approx(modulus - sides + lambda / modulus * pull + mu * askew(0.5)).epsilon(1e-9));
  // Open, and pulled by much along the plane: it holds a wave as a string does, by its own tension E/(1 - nu) 1.5.
  state.deformation_gradient = stretched({{1.5, 1.5, 1.5}});
  CHECK(reported(c, state) == Approx(mu + young / (1 - poisson) * 1.5).epsilon(1e-9));
  // With lambda = 2 mu/3 the stresses are 9, 8 and 7 mu, and 9/4 mu less at the sides of a crack that is parted: from 0 to 23/4.
  // Half of its stiffness left, from 7/2 to 59/8, and waves askew of strains that differ by 1 may have mu/4 more.
  state.deformation_gradient = stretched({{2.5, 2, 1.5}});
  CHECK(reported(c, state) == Approx(mu * (1 + 23. / 4 + 0.25)).epsilon(1e-9));
  state.damage = 0.5;
  CHECK(reported(c, state) == Approx(mu * (1 + 59. / 8 - 7. / 2 + 0.25)).epsilon(1e-9));
  // Askew of the stresses, 22/3 and 16/3 mu, the plane has 19/3 mu, and half of the shear stress mu is left on it.
  state.deformation_gradient = stretched({{2, 2, 1}});
  state.crack_normal = {{std::sqrt(0.5), 0, std::sqrt(0.5)}}, state.damage = 1, state.shear_damage = 0.5;
  CHECK(reported(c, state) == Approx(mu * (1 + 22. / 3 - 19. / 12 + 2 * 0.5 + 0.25)).epsilon(1e-9));
}

TEST_CASE("anisotropic damage: of waves along any direction in bodies with a crack none outruns the reported speed") {
  std::mt19937 numbers(11);
  const auto entry = [&] { return std::ldexp(static_cast<double>(numbers()), -31) - 1; };
  const auto rotation = [&] { return turn(4 * entry(), 0, 1) * turn(4 * entry(), 1, 2) * turn(4 * entry(), 0, 2); };
  double fastest = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    const double size = trial % 3 == 0 ? 0.2 : trial % 3 == 1 ? 0.8 : 2, nu = 0.09 + 0.38 * entry();
    const Law::Constants<double> c(concrete(nu));
    const Mat3 R = rotation(), place = rotation();
    Law::State<3, double> state = whole();
    state.deformation_gradient = R * stretched({{size * entry(), size * entry(), size * entry()}});
    for (int i = 0; i < 3; ++i) state.crack_normal[i] = place(i, 0);
    const auto share = [&] { return trial % 2 ? 0.5 + 0.5 * entry() : entry() > 0 ? 1.0 : 0.0; };
    state.opening_strain = 1, state.damage = share(), state.shear_damage = share();
    const double speed = Law::wave_speed(c, state);
    const Sym<3, double> tau = Law::kirchhoff_stress(c, state);
    const Mat3 ways = trial % 5 ? rotation() : R;
    for (int way = 0; way < 2; ++way) {
      // The acoustic tensor of waves along n: what a (x) n makes of tau n, less the stress that goes along.
      Mat3 acoustic;
      for (int a = 0; a < 3; ++a) {
        Law::State<3, Dual<double>> moved{};
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            double change = 0;
            for (int k = 0; k < 3 && i == a; ++k) change += ways(k, way) * state.deformation_gradient(k, j);
            moved.deformation_gradient(i, j) = Dual<double>(state.deformation_gradient(i, j), change);
          }
        for (int i = 0; i < 3; ++i) moved.crack_normal[i] = state.crack_normal[i];
        moved.opening_strain = state.opening_strain, moved.sliding_strain = 0.0;
        moved.damage = state.damage, moved.shear_damage = state.shear_damage;
        const Sym<3, Dual<double>> rate = Law::kirchhoff_stress(c, moved);
        for (int i = 0; i < 3; ++i) {
          acoustic(i, a) = 0;
          for (int j = 0; j < 3; ++j)
            acoustic(i, a) += (rate(i, j).derivative - ways(a, way) * tau(i, j)) * ways(j, way);
        }
      }
      double shift = 0;  // power iteration finds the largest value where all are positive
      for (const double value : acoustic.m) shift += std::abs(value);
      Vec<3, double> v{{entry(), entry(), entry()}};
      double largest = 0;
      for (int step = 0; step < 200; ++step) {
        Vec<3, double> next{};
        for (int i = 0; i < 3; ++i) {
          next[i] = shift * v[i];
          for (int j = 0; j < 3; ++j) next[i] += acoustic(i, j) * v[j];
        }
        const double length = std::sqrt(next[0] * next[0] + next[1] * next[1] + next[2] * next[2]);
        for (int i = 0; i < 3; ++i) v[i] = next[i] / length;
        largest = length - shift;
      }
      fastest = larger(fastest, largest / (2400 * speed * speed));
    }
  }
  CHECK(fastest < 1 + 1e-9);
  CHECK(fastest > 0.99);
}
