// Coupled Neo-Hookean solid under imposed stretch, the three volumetric energies. E = 1000, nu = 0.3. The tables give
// Cauchy stress; the functor gives Kirchhoff stress. The tolerance 1e-6 relative covers their printed digits.

#include <cmath>

#include "materials/neo_hookean/neo_hookean.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using F3 = Mat<3, double>;

constexpr double mu = 384.6153846153846, lambda = 576.9230769230769;
constexpr VolumetricEnergy forms[] = {VolumetricEnergy::logarithmic, VolumetricEnergy::quadratic,
                                      VolumetricEnergy::simo};

NeoHookean::Constants<double> constants(int volumetric) {
  return NeoHookean::Constants<double>({1000, 0.3, 1000, 0, static_cast<double>(volumetric)});
}

Sym<3, double> cauchy_stress(int volumetric, const F3& F) {
  Sym<3, double> sigma = NeoHookean::kirchhoff_stress(constants(volumetric), NeoHookean::State<3, double>{F});
  for (double& component : sigma.s) component /= determinant(F);
  return sigma;
}

F3 diagonal(double a, double b, double c) {
  return {{a, 0, 0, 0, b, 0, 0, 0, c}};
}

/// The slope lambda U'(J), by way of J U'.
double slope(int volumetric, double J) {
  return lambda * volumetric_stress(forms[volumetric], J) / J;
}

Approx near(double value) {
  return Approx(value).epsilon(1e-6).margin(1e-9);
}

/// The lateral stretch that frees the sides, by Newton with a numerical slope.
double lateral_stretch(int volumetric, double stretch) {
  double side = 1;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const auto lateral = [&](double s) { return cauchy_stress(volumetric, diagonal(stretch, s, s))(1, 1); };
    const double h = 1e-6;
    side -= lateral(side) * 2 * h / (lateral(side + h) - lateral(side - h));
  }
  return side;
}

struct Row {
  double stretch;
  double first[3], second[3];
};

}  // namespace

TEST_CASE("Neo-Hookean: slopes and values of the volumetric energies") {
  const Row slopes[] = {{0.5, {-799.785, -288.462, -432.692}, {}},
                        {2, {199.946, 576.923, 432.692}, {}},
                        {0.9, {-67.5388, -57.6923, -60.8974}, {}}};
  for (const Row& row : slopes)
    for (int k = 0; k < 3; ++k) CHECK(slope(k, row.stretch) == Approx(row.first[k]).epsilon(5e-6));
  const double energies[] = {138.592, 72.1154, 91.7732};
  for (int k = 0; k < 3; ++k) CHECK(lambda * volumetric_energy(forms[k], 0.5) == Approx(energies[k]).epsilon(5e-6));
}

TEST_CASE("Neo-Hookean: slopes are the derivatives of the volumetric energies, tangents those of the slopes") {
  for (const VolumetricEnergy form : forms)
    for (double J : {0.01, 0.1, 0.5, 0.9, 1.0, 1.1, 2.0, 10.0, 100.0}) {
      const double h = 1e-5 * J;
      const double difference = (volumetric_energy(form, J + h) - volumetric_energy(form, J - h)) / (2 * h);
      CHECK(volumetric_stress(form, J) / J == Approx(difference).epsilon(1e-7).margin(1e-8));
      const double second =
          (volumetric_stress(form, J + h) / (J + h) - volumetric_stress(form, J - h) / (J - h)) / (2 * h);
      CHECK(volumetric_tangent(form, J) == Approx(J * J * second).epsilon(1e-7).margin(1e-7 * J));
    }
}

TEST_CASE("Neo-Hookean: limits of the volumetric energies when crushed and when stretched") {
  const double tiny = 1e-12, huge = 1e12, l = std::log(tiny);
  CHECK(volumetric_energy(forms[0], tiny) == near(l * l / 2));
  CHECK(volumetric_energy(forms[1], tiny) == near(0.5));  // the energy is finite: there is no barrier
  CHECK(volumetric_energy(forms[2], tiny) == near(-l / 2 - 0.25));
  CHECK(slope(0, huge) < 1e-6);
  CHECK(slope(1, huge) / huge == near(lambda));
  CHECK(slope(2, huge) / huge == near(lambda / 2));
  // The logarithmic form pulls hardest at J = e and softens beyond.
  const double e = std::exp(1.0);
  CHECK(slope(0, e) == Approx(212.238).epsilon(5e-6));
  CHECK(slope(0, e) > slope(0, e * 1.01));
  CHECK(slope(0, e) > slope(0, e * 0.99));
}

TEST_CASE("tangents of the volumetric energies from J = 0.01 to 100") {
  for (double J : {0.01, 0.1, 1.0, 10.0, 100.0}) {
    CHECK(volumetric_tangent(forms[0], J) == Approx(1 - std::log(J)).epsilon(1e-15).margin(1e-15));
    CHECK(volumetric_tangent(forms[1], J) == Approx(J * J).epsilon(1e-15));
    CHECK(volumetric_tangent(forms[2], J) == Approx((J * J + 1) / 2).epsilon(1e-15));
  }
  CHECK(volumetric_tangent(forms[0], 100.0) < 0);      // the form is unstable beyond J = e
  CHECK(volumetric_tangent(forms[1], 0.01) < 1.1e-4);  // the form is soft when crushed
  CHECK(volumetric_tangent(forms[2], 0.01) > 0.5);     // the form is stiff at both ends
  CHECK(volumetric_tangent(forms[2], 100.0) > 5000);
}

TEST_CASE("Neo-Hookean: uniaxial strain") {
  const Row rows[] = {
      {0.5, {-1376.708285, -865.384615, -1009.615385}, {-799.785208, -288.461538, -432.692308}},
      {2, {776.869379, 1153.846154, 1009.615385}, {199.946302, 576.923077, 432.692308}},
      {0.8, {-333.997753, -288.461538, -302.884615}, {-160.920830, -115.384615, -129.807692}},
      {1.5, {476.460939, 608.974359, 560.897436}, {155.948119, 288.461538, 240.384615}},
  };
  for (const Row& row : rows)
    for (int k = 0; k < 3; ++k) {
      const Sym<3, double> sigma = cauchy_stress(k, diagonal(row.stretch, 1, 1));
      CHECK(sigma(0, 0) == near(row.first[k]));
      CHECK(sigma(1, 1) == near(row.second[k]));
      CHECK(sigma(2, 2) == near(row.second[k]));
      CHECK(sigma(0, 1) == 0);
    }
}

TEST_CASE("Neo-Hookean: uniaxial stress") {
  const Row rows[] = {
      {0.5, {1.21076739, 1.15470054, 1.17834984}, {-638.048474, -625.0, -630.731284}},
      {2, {.79807754, .77950319, .78426354}, {1015.412883, 1073.654855, 1058.333134}},
      {1.5, {.88017459, .87186846, .87423283}, {488.287861, 502.544650, 498.445007}},
  };
  for (const Row& row : rows)
    for (int k = 0; k < 3; ++k) {
      const double side = lateral_stretch(k, row.stretch);
      CHECK(side == near(row.first[k]));
      CHECK(cauchy_stress(k, diagonal(row.stretch, side, side))(0, 0) == near(row.second[k]));
    }
}

TEST_CASE("Neo-Hookean: simple shear") {
  for (int k = 0; k < 3; ++k)
    for (double gamma : {0.1, 0.5, 2.0}) {
      F3 F = F3::identity();
      F(0, 1) = gamma;
      const Sym<3, double> sigma = cauchy_stress(k, F);
      CHECK(sigma(0, 1) == near(mu * gamma));
      CHECK(sigma(0, 0) == near(mu * gamma * gamma));
      CHECK(std::abs(sigma(1, 1)) < 1e-10);
      CHECK(std::abs(sigma(2, 2)) < 1e-10);
    }
}

TEST_CASE("Neo-Hookean: the fastest wave in closed form, longitudinal or shear") {
  const auto modulus = [](int volumetric, const F3& F) {  // rho0 c^2; the density is 1000
    const double speed = NeoHookean::wave_speed(constants(volumetric), NeoHookean::State<3, double>{F});
    return 1000 * speed * speed;
  };
  // Along the stretch: mu (1 + s^2) + lambda J^2 u'' with J = s.
  for (double s : {1.1, 1.7, 2.5}) {
    CHECK(modulus(0, diagonal(s, 1, 1)) == near(mu * (1 + s * s) + lambda * (1 - std::log(s))));
    CHECK(modulus(1, diagonal(s, 1, 1)) == near(mu * (1 + s * s) + lambda * s * s));
    CHECK(modulus(2, diagonal(s, 1, 1)) == near(mu * (1 + s * s) + lambda * (s * s + 1) / 2));
  }
  // Stretched by e in all directions (ln J)^2/2 has softened so far that the shear wave, mu e^2, is the fastest.
  const double e = std::exp(1.0);
  CHECK(mu * (1 + e * e) - 2 * lambda < mu * e * e);
  CHECK(modulus(0, diagonal(e, e, e)) == near(mu * e * e));
}
