// Mooney-Rivlin rubber under imposed deformation, against the textbook's stresses where the volume stays, and against
// the derivatives of the three volumetric energies where the shape does.

#include <cmath>

#include "materials/mooney_rivlin/mooney_rivlin.hpp"
#include "materials/neo_hookean/neo_hookean.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using Mat3 = Mat<3, double>;

constexpr double c10 = 140, c01 = 55, density = 1100;
enum { logarithmic, quadratic, simo };

MooneyRivlin::Constants<double> constants(double bulk, int form = simo) {
  return MooneyRivlin::Constants<double>({c10, c01, bulk, density, static_cast<double>(form)});
}
Sym<3, double> kirchhoff(const Mat3& F, double bulk = 900, int form = simo) {
  return MooneyRivlin::kirchhoff_stress(constants(bulk, form), MooneyRivlin::State<3, double>{F});
}
double energy(const Mat3& F, double bulk = 900, int form = simo) {
  return MooneyRivlin::stored_energy(constants(bulk, form), MooneyRivlin::State<3, double>{F});
}
double wave_modulus(const Mat3& F, double bulk = 900, int form = simo) {
  const double speed = MooneyRivlin::wave_speed(constants(bulk, form), MooneyRivlin::State<3, double>{F});
  return density * speed * speed;
}
Mat3 diagonal(double x, double y, double z) {
  return {{x, 0, 0, 0, y, 0, 0, 0, z}};
}
double uniaxial(double s) {
  return 2 * (s * s - 1 / s) * (c10 + c01 / s);
}

}  // namespace

TEST_CASE("Mooney-Rivlin: simple shear gives 2 (C10 + C01) gamma and the two normal stress differences") {
  for (double gamma : {-1.5, -0.2, 0.01, 0.5, 2.0}) {
    CAPTURE(gamma);
    const Mat3 F{{1, gamma, 0, 0, 1, 0, 0, 0, 1}};
    const Sym<3, double> tau = kirchhoff(F);
    CHECK(tau(0, 1) == Approx(2 * (c10 + c01) * gamma).epsilon(1e-12));
    CHECK(tau(0, 0) - tau(2, 2) == Approx(2 * c10 * gamma * gamma).epsilon(1e-9));
    CHECK(tau(1, 1) - tau(2, 2) == Approx(-2 * c01 * gamma * gamma).epsilon(1e-9));
    const Sym<3, double> lifted = kirchhoff({{1, 0, gamma, 0, 1, 0, 0, 0, 1}});
    const Sym<3, double> turned = kirchhoff({{1, 0, 0, 0, 1, gamma, 0, 0, 1}});
    CHECK(lifted(0, 2) == Approx(tau(0, 1)).epsilon(1e-12));
    CHECK(turned(1, 2) == Approx(tau(0, 1)).epsilon(1e-12));
    CHECK(std::abs(trace(tau)) < 1e-10);
    CHECK(energy(F) == Approx((c10 + c01) * gamma * gamma).epsilon(1e-9));  // both invariants are 3 + gamma^2
  }
}

TEST_CASE("Mooney-Rivlin: uniaxial, equibiaxial and planar stretch at constant volume") {
  for (double s : {0.4, 0.9, 1.2, 2.0, 4.0}) {
    CAPTURE(s);
    const Sym<3, double> along = kirchhoff(diagonal(s, 1 / std::sqrt(s), 1 / std::sqrt(s)));
    CHECK(along(0, 0) - along(1, 1) == Approx(uniaxial(s)).epsilon(1e-11));
    CHECK(along(1, 1) == Approx(along(2, 2)).epsilon(1e-12));
    const Sym<3, double> sheet = kirchhoff(diagonal(s, s, 1 / (s * s)));
    const double squeezed = s * s - std::pow(s, -4);
    CHECK(sheet(0, 0) - sheet(2, 2) == Approx(2 * squeezed * (c10 + c01 * s * s)).epsilon(1e-11));
    const Sym<3, double> planar = kirchhoff(diagonal(s, 1, 1 / s));
    CHECK(planar(0, 0) - planar(2, 2) == Approx(2 * (s * s - 1 / (s * s)) * (c10 + c01)).epsilon(1e-11));
    const double first = s * s + 2 / s, second = 2 * s + 1 / (s * s);
    CHECK(energy(diagonal(s, 1 / std::sqrt(s), 1 / std::sqrt(s))) ==
          Approx(c10 * (first - 3) + c01 * (second - 3)).epsilon(1e-10));
  }
}

TEST_CASE(
    "Mooney-Rivlin: with free sides stress is that of the isochoric stretch, and a third of it changes the volume") {
  for (double s : {0.6, 1.5, 3.0})
    for (double bulk : {900.0, 1e6}) {
      CAPTURE(s, bulk);
      // The sides' stretch by a secant on their stress.
      const auto lateral = [&](double side) { return kirchhoff(diagonal(s, side, side), bulk)(1, 1); };
      double a = 1 / std::sqrt(s), b = a * (1 + 1e-3), at_a = lateral(a), at_b = lateral(b);
      for (int k = 0; k < 50 && at_b != at_a && std::abs(at_b) > 1e-8; ++k) {
        const double next = b - at_b * (b - a) / (at_b - at_a);
        a = b, at_a = at_b;
        b = next, at_b = lateral(b);
      }
      REQUIRE(std::abs(at_b) < 1e-7);
      const double J = s * b * b, pressure = bulk * (J * J - 1) / 2, found = kirchhoff(diagonal(s, b, b), bulk)(0, 0);
      CHECK(found == Approx(uniaxial(s / std::cbrt(J))).epsilon(1e-9));
      CHECK(found == Approx(3 * pressure).epsilon(1e-9));
    }
}

TEST_CASE("Mooney-Rivlin: small strains have the moduli mu = 2 (C10 + C01) and K") {
  const double mu = 2 * (c10 + c01), bulk = 900, size = 1e-4;  // what is left of the third order is 1e-8 of the strain
  const Mat3 strain{{0.5, 0.3, -0.4, 0.3, -0.7, 0.2, -0.4, 0.2, 0.6}};
  const double volume = strain(0, 0) + strain(1, 1) + strain(2, 2);
  for (int form : {logarithmic, quadratic, simo}) {
    Mat3 stretched = Mat3::identity(), pressed = Mat3::identity();
    for (int k = 0; k < 9; ++k) stretched.m[k] += size * strain.m[k], pressed.m[k] -= size * strain.m[k];
    const Sym<3, double> after = kirchhoff(stretched, bulk, form), before = kirchhoff(pressed, bulk, form);
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) {
        const double linear = 2 * mu * strain(i, j) + (i == j ? (bulk - 2 * mu / 3) * volume : 0);
        CHECK((after(i, j) - before(i, j)) / (2 * size) == Approx(linear).epsilon(1e-6));
      }
  }
}

TEST_CASE("Mooney-Rivlin: a change of volume alone has the energy and stress of u(J)") {
  const double bulk = 900;
  for (double J : {0.2, 0.8, 1.3, 4.0}) {
    CAPTURE(J);
    const double side = std::cbrt(J), l = std::log(J);
    const Mat3 F = diagonal(side, side, side);
    const double energies[] = {l * l / 2, (J - 1) * (J - 1) / 2, ((J * J - 1) / 2 - l) / 2};
    const double stresses[] = {l, J * (J - 1), (J * J - 1) / 2};
    for (int form : {logarithmic, quadratic, simo}) {
      CHECK(energy(F, bulk, form) == Approx(bulk * energies[form]).epsilon(1e-10));
      for (int i = 0; i < 3; ++i) CHECK(kirchhoff(F, bulk, form).s[i] == Approx(bulk * stresses[form]).epsilon(1e-10));
    }
  }
}

TEST_CASE("Mooney-Rivlin: without C01 it is the split Neo-Hookean solid") {
  const double bulk = 900, mu = 2 * c10, young = 9 * bulk * mu / (3 * bulk + mu),
               poisson = (3 * bulk - 2 * mu) / (2 * (3 * bulk + mu));
  const Mat3 F{{1.3, 0.2, -0.1, 0.05, 0.8, 0.3, -0.2, 0.1, 1.1}};
  for (int form : {logarithmic, quadratic, simo}) {
    const MooneyRivlin::Constants<double> one({c10, 0, bulk, density, static_cast<double>(form)});
    const NeoHookean::Constants<double> other({young, poisson, density, 1, static_cast<double>(form)});
    const auto a = MooneyRivlin::kirchhoff_stress(one, MooneyRivlin::State<3, double>{F});
    const auto b = NeoHookean::kirchhoff_stress(other, NeoHookean::State<3, double>{F});
    for (int k = 0; k < 6; ++k) CHECK(a.s[k] == Approx(b.s[k]).epsilon(1e-11));
  }
}

TEST_CASE("Mooney-Rivlin: the wave at rest is the longitudinal one, and along a stretch none is faster than reported") {
  const double mu = 2 * (c10 + c01), bulk = 900;
  CHECK(wave_modulus(diagonal(1, 1, 1)) == Approx(bulk + 4 * mu / 3).epsilon(1e-12));
  // Along a principal axis d2 psi/ds2 of the stretch and of a shear, by hand; J = 1.
  for (double s : {0.5, 0.8, 1.25, 2.0})
    for (int axis : {0, 1}) {
      CAPTURE(s, axis);
      const double stretch[] = {s, 1 / std::sqrt(s), 1 / std::sqrt(s)};
      double first = 0, second = 0;
      for (double value : stretch) first += value * value, second += 1 / (value * value);
      const double n = stretch[axis] * stretch[axis],
                   reported = wave_modulus(diagonal(stretch[0], stretch[1], stretch[2]));
      const double longitudinal = bulk + 2 * c10 * (5 * first / 9 - n / 3) + 2 * c01 * (5 / (3 * n) - second / 9);
      CHECK(reported >= longitudinal * (1 - 1e-12));
      for (int other : {0, 1, 2})
        if (other != axis) CHECK(reported >= 2 * c10 * n + 2 * c01 / (stretch[other] * stretch[other]));
    }
}

TEST_CASE("Mooney-Rivlin: plane strain and a strain around the axis are those of 3-D") {
  const auto c = constants(900);
  const Sym<3, double> flat_in_space = kirchhoff({{1.2, 0.3, 0, -0.1, 0.9, 0, 0, 0, 1}});
  const auto flat = MooneyRivlin::kirchhoff_stress(c, MooneyRivlin::State<2, double>{{{1.2, 0.3, -0.1, 0.9}}});
  const Sym<3, double> ring_in_space = kirchhoff({{1.2, 0.3, 0, -0.1, 0.9, 0, 0, 0, 0.7}});
  const auto ring =
      MooneyRivlin::kirchhoff_stress(c, MooneyRivlin::AxisymmetricState<double>{{{{1.2, 0.3, -0.1, 0.9}}, 0.7}});
  for (int i = 0; i < 3; ++i) {
    CHECK(flat.s[i] == Approx(flat_in_space.s[i]).epsilon(1e-11));
    CHECK(ring.s[i] == Approx(ring_in_space.s[i]).epsilon(1e-11));
  }
  CHECK(flat(0, 1) == Approx(flat_in_space(0, 1)).epsilon(1e-11));
  CHECK(ring(0, 1) == Approx(ring_in_space(0, 1)).epsilon(1e-11));
}
