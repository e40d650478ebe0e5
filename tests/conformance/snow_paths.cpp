// Snow under imposed deformation against the law written out for stretches along the axes: F_E is the clamped stretch,
// J_P the rest, h = exp(xi (1 - J_P)). E = 1000, nu = 0.2 unless said otherwise.

#include <algorithm>
#include <cmath>
#include <random>

#include "kernel/lanes.hpp"
#include "materials/fixed_corotated/fixed_corotated.hpp"
#include "materials/snow/snow.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;
using State3 = Snow::State<3, double>;

constexpr double young = 1000, poisson = 0.2, density = 400;
constexpr double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));

/// One particle driven by increments dt L along the axes.
struct Particle {
  Snow::Constants<double> constants;
  State3 state{Mat3::identity(), 1};
  double heat = 0, work = 0;

  explicit Particle(double compression = 0.025, double stretch = 0.0075, double hardening = 10, double largest = 100)
      : constants({young, poisson, density, compression, stretch, hardening, largest}) {}

  Sym<3, double> stress() const { return Snow::kirchhoff_stress(constants, state); }
  double energy() const { return Snow::stored_energy(constants, state); }
  double stretch(int axis) const { return state.elastic_deformation_gradient(axis, axis); }
  double wave_modulus() const {
    const double speed = Snow::wave_speed(constants, state);
    return density * speed * speed;
  }
  /// Takes the stretch along x from one value to another in equal steps, and adds up the work by the trapezoidal rule.
  void pull(double from, double to, int steps) {
    for (int k = 0; k < steps; ++k) {
      const double a = from + (to - from) * k / steps, b = from + (to - from) * (k + 1) / steps;
      const double before = stress()(0, 0);
      heat += Snow::advance(constants, Mat3{{b / a - 1, 0, 0, 0, 0, 0, 0, 0, 0}}, 1.0, state);
      work += 0.5 * (before / a + stress()(0, 0) / b) * (b - a);
    }
  }
};

/// The first two principal stresses and the energy of the stretch s along x alone, without hardening.
struct Uniaxial {
  double axial, lateral, energy;
  explicit Uniaxial(double s)
      : axial(2 * mu * (s - 1) * s + lambda * (s - 1) * s),
        lateral(lambda * (s - 1) * s),
        energy((mu + lambda / 2) * (s - 1) * (s - 1)) {}
};

}  // namespace

TEST_CASE("snow: compression beyond theta_c keeps F_E there, and the rest hardens") {
  struct Row {
    double compression, hardening, stretch, plastic, factor;
  };
  for (const Row& row : {Row{0.025, 10, 0.9, 0.92307692, 2.15810553}, Row{0.05, 5, 0.8, 0.84210526, 2.20223705}})
    for (int steps : {1, 7, 400}) {
      CAPTURE(row.stretch, steps);
      Particle snow(row.compression, 0.0075, row.hardening);
      snow.pull(1, row.stretch, steps);
      const Uniaxial exact(1 - row.compression);
      CHECK(snow.stretch(0) == Approx(1 - row.compression).epsilon(1e-13));
      CHECK(snow.stretch(1) == Approx(1).epsilon(1e-13));
      CHECK(snow.state.plastic_volume_ratio == Approx(row.plastic).epsilon(1e-8));
      CHECK(Snow::volume_ratio(snow.state) == Approx(row.stretch).epsilon(1e-12));
      CHECK(snow.stress()(0, 0) == Approx(row.factor * exact.axial).epsilon(1e-8));
      CHECK(snow.stress()(1, 1) == Approx(row.factor * exact.lateral).epsilon(1e-8));
      CHECK(snow.stress()(2, 2) == Approx(row.factor * exact.lateral).epsilon(1e-8));
      CHECK(snow.energy() == Approx(row.factor * exact.energy).epsilon(1e-8));
    }
}

TEST_CASE("snow: stretch beyond theta_s keeps F_E there, and the rest softens") {
  for (int steps : {1, 60}) {
    Particle snow;
    snow.pull(1, 1.05, steps);
    const double plastic = 1.05 / 1.0075, factor = std::exp(10 * (1 - plastic));
    CHECK(snow.stretch(0) == Approx(1.0075).epsilon(1e-13));
    CHECK(snow.state.plastic_volume_ratio == Approx(plastic).epsilon(1e-12));
    CHECK(snow.stress()(0, 0) == Approx(factor * Uniaxial(1.0075).axial).epsilon(1e-11));
    CHECK(snow.stress()(1, 1) == Approx(factor * Uniaxial(1.0075).lateral).epsilon(1e-11));
    CHECK(snow.heat > 0);
  }
}

TEST_CASE("snow: each axis yields by itself, and J stays the product") {
  Particle snow;
  Snow::advance(snow.constants, Mat3{{-0.1, 0, 0, 0, 0.04, 0, 0, 0, 0.005}}, 1.0, snow.state);
  CHECK(snow.stretch(0) == Approx(0.975).epsilon(1e-13));
  CHECK(snow.stretch(1) == Approx(1.0075).epsilon(1e-13));
  CHECK(snow.stretch(2) == Approx(1.005).epsilon(1e-13));
  const double elastic = 0.975 * 1.0075 * 1.005;
  CHECK(snow.state.plastic_volume_ratio == Approx(0.9 * 1.04 * 1.005 / elastic).epsilon(1e-12));
  const double factor = std::exp(10 * (1 - 0.9 * 1.04 * 1.005 / elastic));
  const double pressure = lambda * (elastic - 1) * elastic;
  CHECK(snow.stress()(1, 1) == Approx(factor * (2 * mu * 0.0075 * 1.0075 + pressure)).epsilon(1e-11));
}

TEST_CASE("snow: within the elastic range it is fixed corotated to rounding, and keeps F_E to the last bit") {
  const FixedCorotated::Constants<double> elastic({young, poisson, density});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> entry(-0.002, 0.002);
  Particle snow;
  const Mat3 turned{{0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1}};
  snow.state.elastic_deformation_gradient = turned;
  for (int k = 0; k < 200; ++k) {
    Mat3 L;
    for (double& e : L.m) e = entry(random);
    const Mat3 F = advanced(turned, L, 1.0);
    snow.state.elastic_deformation_gradient = turned;
    REQUIRE(Snow::advance(snow.constants, L, 1.0, snow.state) == 0);
    REQUIRE(snow.state.plastic_volume_ratio == 1);
    for (int i = 0; i < 9; ++i) REQUIRE(snow.state.elastic_deformation_gradient.m[i] == F.m[i]);
    const FixedCorotated::State<3, double> same{F};
    const Sym<3, double> expected = FixedCorotated::kirchhoff_stress(elastic, same), found = snow.stress();
    double apart = 0;
    for (int i = 0; i < 6; ++i) apart = larger(apart, std::abs(found.s[i] - expected.s[i]));
    CHECK(apart < 1e-12 * young);
    CHECK(std::abs(snow.energy() - FixedCorotated::stored_energy(elastic, same)) < 1e-14 * young);
  }
}

TEST_CASE("snow: moduli grow as exp(xi (1 - J_P)), and stay within the bound") {
  Particle snow;
  snow.state.elastic_deformation_gradient(0, 0) = 0.99;
  const double axial = snow.stress()(0, 0), energy = snow.energy();
  CHECK(axial == Approx(Uniaxial(0.99).axial).epsilon(1e-12));
  const double rows[][2] = {{0.9, 2.71828183}, {1.02, 0.81873075}, {0.55, 90.0171313}, {0.5, 100},
                            {1e-9, 100},       {1.5, 0.01},        {20, 0.01}};
  for (const auto& [plastic, factor] : rows) {
    CAPTURE(plastic);
    snow.state.plastic_volume_ratio = plastic;
    CHECK(snow.stress()(0, 0) / axial == Approx(factor).epsilon(1e-8));
    CHECK(snow.energy() / energy == Approx(factor).epsilon(1e-8));
  }
}

TEST_CASE("snow: the work of compaction is stored energy and heat, and all of it heat once the load is off") {
  Particle snow;
  snow.pull(1, 0.9, 400);
  // On the way from J_P = 1 to P the stress h t works through dJ_P/J_P, and psi0 dh of it is stored.
  const Uniaxial exact(0.975);
  const double end = 0.9 / 0.975;
  double integral = 0;
  const int intervals = 2000;  // of Simpson's rule
  for (int k = 0; k <= intervals; ++k) {
    const double plastic = 1 + (end - 1) * k / intervals;
    integral += (k == 0 || k == intervals ? 1 : k % 2 ? 4 : 2) * std::exp(10 * (1 - plastic)) / plastic;
  }
  integral *= (end - 1) / intervals / 3;
  const double factor = std::exp(10 * (1 - end)), heat = exact.axial * integral - (factor - 1) * exact.energy;
  CHECK(snow.heat == Approx(heat).epsilon(1e-4));
  CHECK(snow.work == Approx(snow.heat + factor * exact.energy).epsilon(1e-4));
  const double booked = snow.heat;
  snow.pull(0.9, end, 400);  // F_E goes back to 1
  CHECK(snow.heat == booked);
  CHECK(std::abs(snow.energy()) < 1e-12 * young);
  CHECK(snow.work == Approx(snow.heat).epsilon(1e-4));
}

TEST_CASE("snow: parting gives the softened snow's energy away as heat") {
  Particle snow;
  snow.pull(1, 1.1, 400);
  const Uniaxial exact(1.0075);
  const double factor = std::exp(10 * (1 - 1.1 / 1.0075));
  CHECK(snow.energy() == Approx(factor * exact.energy).epsilon(1e-8));
  CHECK(snow.work == Approx(snow.heat + snow.energy()).epsilon(1e-4));
}

TEST_CASE("snow: parting under pressure from the sides makes energy below J_P = 0.624, as the law's inequality says") {
  // D/h = tau0_x + xi J_P psi0 for each unit of plastic stretch along x, by hand; the paper's h, which has no bound.
  const double stretch[] = {1.0075, 0.975, 0.975}, J = 1.0075 * 0.975 * 0.975;
  const double axial = 2 * mu * 0.0075 * 1.0075 + lambda * (J - 1) * J,
               energy = mu * (0.0075 * 0.0075 + 2 * 0.025 * 0.025) + lambda / 2 * (J - 1) * (J - 1);
  CHECK(axial == Approx(-4.94219335));
  CHECK(energy == Approx(0.79214117));
  for (double plastic : {0.5, 0.62, 0.63, 0.9}) {
    CAPTURE(plastic);
    Particle snow(0.025, 0.0075, 10, 1e9);
    snow.state = {Mat3{{stretch[0], 0, 0, 0, stretch[1], 0, 0, 0, stretch[2]}}, plastic};
    const double heat = Snow::advance(snow.constants, Mat3{{1e-6, 0, 0, 0, 0, 0, 0, 0, 0}}, 1.0, snow.state);
    CHECK(snow.state.plastic_volume_ratio == Approx(plastic * (1 + 1e-6)).epsilon(1e-13));
    CHECK((heat < 0) == (plastic < 0.624));
    CHECK(heat / 1e-6 == Approx(std::exp(10 * (1 - plastic)) * (axial + 10 * plastic * energy)).epsilon(1e-3));
  }
}

TEST_CASE("snow: compaction of all axes makes energy where xi J_P theta_c is more than 2/3") {
  const double compression = 1e-3, s = 1 - compression, J = s * s * s;
  const double axial = 2 * mu * (s - 1) * s + lambda * (J - 1) * J,
               energy = 3 * mu * (s - 1) * (s - 1) + lambda / 2 * (J - 1) * (J - 1);
  for (double product : {0.5, 0.66, 0.675, 0.9}) {
    CAPTURE(product);
    Particle snow(compression, 0.0075, product / compression, 1e9);
    snow.state.elastic_deformation_gradient = Mat3{{s, 0, 0, 0, s, 0, 0, 0, s}};
    const double heat = Snow::advance(snow.constants, Mat3{{-1e-8, 0, 0, 0, -1e-8, 0, 0, 0, -1e-8}}, 1.0, snow.state);
    CHECK((heat < 0) == (product > 2.0 / 3));
    CHECK(heat / -3e-8 == Approx(axial + product / compression * energy).epsilon(1e-3));
  }
}

TEST_CASE("snow: work is stored and dissipated energy where the law makes energy too") {
  for (double largest : {100.0, 1e9}) {  // at J_P = 0.5 the first h is at its bound, the second is not
    Particle snow(0.025, 0.0075, 10, largest);
    snow.state = {Mat3{{1.0075, 0, 0, 0, 0.975, 0, 0, 0, 0.975}}, 0.5};
    const double before = snow.energy();
    snow.pull(1, 1.01, 2000);
    CHECK(snow.heat < 0);
    CHECK(snow.work < 0);
    CHECK(snow.work == Approx(snow.heat + snow.energy() - before).epsilon(1e-4));
  }
}

TEST_CASE("snow: crushed to a thousandth it stays finite") {
  Particle snow;
  double at = 1;
  for (int k = 0; k < 100; ++k) {
    const double next = at * std::pow(1e-3, 0.01);
    snow.pull(at, next, 1);
    at = next;
  }
  CHECK(Snow::volume_ratio(snow.state) == Approx(1e-3).epsilon(1e-11));
  CHECK(snow.state.plastic_volume_ratio == Approx(1e-3 / 0.975).epsilon(1e-11));
  CHECK(snow.stress()(0, 0) == Approx(100 * Uniaxial(0.975).axial).epsilon(1e-11));
}

TEST_CASE("snow: the wave at rest is the longitudinal one, and hardening makes it faster") {
  Particle snow;
  CHECK(snow.wave_modulus() == Approx(lambda + 2 * mu).epsilon(1e-12));
  snow.state.plastic_volume_ratio = 0.9;
  CHECK(snow.wave_modulus() == Approx(2.71828183 * (lambda + 2 * mu)).epsilon(1e-8));
}

TEST_CASE(
    "snow: a wave that parts snow pressed from its sides is carried by softening, and is not faster than reported") {
  Particle snow(0.3, 0.02, 40, 1e9);
  snow.state.elastic_deformation_gradient = Mat3{{1.02, 0, 0, 0, 0.7, 0, 0, 0, 0.7}};
  const double stress = snow.stress()(0, 0), reported = snow.wave_modulus();
  // The stretch along x stays at its bound: dtau = -xi J_P tau ds by h alone, and rho0 c^2 = dtau/ds - tau.
  const double softening = -(1 + 40) * stress, elastic = 2 * mu * 1.02 * 1.02;
  CHECK(softening > 2 * elastic);
  CHECK(reported >= softening);
  Snow::advance(snow.constants, Mat3{{1e-6, 0, 0, 0, 0, 0, 0, 0, 0}}, 1.0, snow.state);
  CHECK((snow.stress()(0, 0) - stress) / 1e-6 - stress == Approx(softening).epsilon(1e-4));
}

TEST_CASE("snow: in plane strain z stays elastic, around an axis it yields like the others") {
  Snow::Constants<double> c({young, poisson, density, 0.025, 0.0075, 10, 100});
  Snow::State<2, double> flat{Mat<2, double>::identity(), 1};
  Snow::advance(c, Mat<2, double>{{-0.1, 0, 0, 0}}, 1.0, flat);
  CHECK(Snow::kirchhoff_stress(c, flat).s[2] == Approx(2.15810553 * Uniaxial(0.975).lateral).epsilon(1e-8));
  Snow::AxisymmetricState<double> ring{Deformation<2, double>::identity(), 1};
  Snow::advance(c, Deformation<2, double>{{{0, 0, 0, 0}}, -0.1}, 1.0, ring);
  CHECK(ring.elastic_deformation_gradient.zz == Approx(0.975).epsilon(1e-13));
  CHECK(ring.plastic_volume_ratio == Approx(0.92307692).epsilon(1e-8));
  CHECK(Snow::kirchhoff_stress(c, ring).s[2] == Approx(2.15810553 * Uniaxial(0.975).axial).epsilon(1e-8));
}

TEST_CASE("snow: the reported wave is the elastic one, and what hardening and the carried stress add, along any axis") {
  // rho0 c^2 = h (2 mu s^2 + lambda J_E^2 + (1 + xi J_P) max |tau_i|), s the largest stretch; no xi where h is at its bound.
  double stretch[3] = {0.98, 1.0, 1.005};
  do {
    for (double plastic : {0.9, 1.1, 0.5, 1.5})  // at the last two exp(xi (1 - J_P)) is beyond 100 and 1/100
      for (double nu : {0.2, -0.4}) {
        CAPTURE(stretch[0], stretch[1], stretch[2], plastic, nu);
        const double G = young / (2 * (1 + nu)), lame = young * nu / ((1 + nu) * (1 - 2 * nu));
        const double J = 0.98 * 1.005, pressure = lame * (J - 1) * J;
        const double strongest =
            std::max(std::abs(2 * G * -0.02 * 0.98 + pressure), std::abs(2 * G * 0.005 * 1.005 + pressure));
        const bool bounded = plastic == 0.5 || plastic == 1.5;
        const double h = std::exp(10 * (1 - plastic)), factor = std::min(std::max(h, 0.01), 100.0);
        const double rate = bounded ? 0 : 10 * plastic;
        const auto modulus = [&](const auto& state) {
          const Snow::Constants<double> c({young, nu, density, 0.025, 0.0075, 10, 100});
          const double speed = Snow::wave_speed(c, state);
          return density * speed * speed;
        };
        const auto expected = [&](double s) {
          return factor * (2 * G * s * s + std::max(lame * J * J, 0.0) + (1 + rate) * strongest);
        };
        const State3 state{Mat3{{stretch[0], 0, 0, 0, stretch[1], 0, 0, 0, stretch[2]}}, plastic};
        CHECK(modulus(state) == Approx(expected(1.005)).epsilon(1e-9));
        // In the plane waves run along two axes alone.
        const Mat<2, double> plane{{stretch[0], 0, 0, stretch[1]}};
        const Snow::AxisymmetricState<double> ring{{plane, stretch[2]}, plastic};
        CHECK(modulus(ring) == Approx(expected(std::max(stretch[0], stretch[1]))).epsilon(1e-9));
      }
  } while (std::next_permutation(stretch, stretch + 3));
}

TEST_CASE("snow: of a pack in which some particles yield the others advance as they would by themselves") {
  using L = Lanes<double>;
  const Snow::Constants<double> c({young, poisson, density, 0.025, 0.0075, 10, 100});
  alignas(lane_bytes) double strain[L::width];
  for (int lane = 0; lane < L::width; ++lane) strain[lane] = lane % 2 ? -0.1 : -0.01;
  Snow::AxisymmetricState<L> pack{Deformation<2, L>::identity(), L(1.0)};
  const L along = L::load(strain), none(0.0);
  Snow::advance(c, Deformation<2, L>{{{along, none, none, none}}, along}, 1.0, pack);
  for (int lane = 0; lane < L::width; ++lane) {
    Snow::AxisymmetricState<double> one{Deformation<2, double>::identity(), 1};
    Snow::advance(c, Deformation<2, double>{{{strain[lane], 0, 0, 0}}, strain[lane]}, 1.0, one);
    for (int k = 0; k < 4; ++k)
      CHECK(pack.elastic_deformation_gradient.plane.m[k][lane] ==
            Approx(one.elastic_deformation_gradient.plane.m[k]).epsilon(1e-14).margin(1e-14));
    CHECK(pack.elastic_deformation_gradient.zz[lane] == Approx(one.elastic_deformation_gradient.zz).epsilon(1e-14));
    CHECK(pack.plastic_volume_ratio[lane] == Approx(one.plastic_volume_ratio).epsilon(1e-14));
  }
}
