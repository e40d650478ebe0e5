#pragma once
// A particle of soil that is driven along paths of strain, for tests of laws that build on Hencky's. Stresses are Kirchhoff's.

#include <cmath>
#include <functional>

#include "kernel/hencky.hpp"
#include "support/catch.hpp"

namespace mpm::test::soils {

using Mat3 = Mat<3, double>;
using Vec3 = Vec<3, double>;

inline constexpr double young = 1e7, poisson = 0.3, bulk = young / (3 * (1 - 2 * poisson)),
                        shear = young / (2 * (1 + poisson));
inline constexpr double degree = 3.14159265358979323846 / 180;

inline Mat3 diagonal(double x, double y, double z) {
  return {{x, 0, 0, 0, y, 0, 0, 0, z}};
}

/// One particle of a material, driven by increments dt L over steps of `dt`.
template <class Material>
struct Particle {
  typename Material::template Constants<double> constants;
  typename Material::template State<3, double> state{{Mat3::identity()}, 1};
  double dt = 1, heat = 0, work = 0;

  explicit Particle(const typename Material::Parameters& parameters) : constants(parameters) {}

  Sym<3, double> stress() const { return Material::kirchhoff_stress(constants, state); }
  double energy() const { return Material::stored_energy(constants, state); }
  double mean_strain() const { return HenckySolid::sum(Material::prepared(state).strain); }
  double p() const { return -trace(stress()) / 3; }
  double q() const { return std::sqrt(1.5 * squared_norm(deviator(stress()))); }

  /// Strains by one increment, and adds heat and work, the latter by the trapezoidal rule. Returns the heat.
  double advance(const Mat3& increment) {
    Mat3 rate = increment;
    for (double& entry : rate.m) entry /= dt;
    const Sym<3, double> before = stress();
    const double now = Material::advance(constants, rate, dt, state);
    const Sym<3, double> after = stress();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) work += 0.5 * (before(i, j) + after(i, j)) * increment(i, j);
    heat += now;
    return now;
  }
  /// Strains along the axes by logarithmic strains.
  double strain(double x, double y, double z) { return advance(diagonal(std::expm1(x), std::expm1(y), std::expm1(z))); }

  /// Strains by `axial` along x so that the stresses along y and z stay at -side: the lateral strain by a secant.
  void squeeze(double axial, double side) {
    const Particle before = *this;
    const auto miss = [&](double lateral) {
      *this = before;
      strain(axial, lateral, lateral);
      return (stress()(1, 1) + side) / side;
    };
    double a = 0, b = -poisson * axial, at_a = miss(a), at_b = miss(b);
    for (int iteration = 0; iteration < 60 && std::abs(at_b) > 1e-13 && at_a != at_b; ++iteration) {
      const double next = b - at_b * (b - a) / (at_b - at_a);
      a = b, at_a = at_b;
      b = next, at_b = miss(b);
    }
    REQUIRE(std::abs(at_b) < 1e-9);
  }
};

/// Stresses of small-strain elasticity, which Hencky's law is in logarithmic strains, and back.
inline Vec3 elastic_stress(const Vec3& e) {
  const double mean = (bulk - 2 * shear / 3) * (e[0] + e[1] + e[2]);
  return {{2 * shear * e[0] + mean, 2 * shear * e[1] + mean, 2 * shear * e[2] + mean}};
}

/// sqrt(dev : dev/2).
template <class Material>
double shear_stress(const Particle<Material>& particle) {
  return std::sqrt(0.5 * squared_norm(deviator(particle.stress())));
}
/// The root of a function that rises from a to b.
inline double root_of(double a, double b, const std::function<double(double)>& f) {
  for (int k = 0; k < 200; ++k) (f(0.5 * (a + b)) < 0 ? a : b) = 0.5 * (a + b);
  return 0.5 * (a + b);
}

/// Strains of `size` go round and end where they began, within the elastic range: no heat, and the energy is back.
template <class Material>
void check_elastic_loop(Particle<Material>& particle, double size) {
  const double energy = particle.energy();
  const double legs[4][3] = {{1, -2, 0.5}, {-2, 1, 0}, {-1, 2, -0.5}, {2, -1, 0}};
  for (const auto& leg : legs)
    for (int step = 0; step < 50; ++step) particle.strain(size / 50 * leg[0], size / 50 * leg[1], size / 50 * leg[2]);
  CHECK(particle.heat == 0);
  CHECK(particle.energy() == Approx(energy).epsilon(1e-10));
}

}  // namespace mpm::test::soils
