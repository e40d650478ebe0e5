// An ideal gas that shocks heat, under imposed changes of volume, against closed forms.

#include <cmath>
#include <random>

#include "materials/ideal_gas/ideal_gas.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;

IdealGas::Parameters air(double quadratic = 2, double linear = 0.5) {
  return {101325, 1.2, 1.4, quadratic, linear, 0.01};
}

template <class T = double>
struct Particle {
  explicit Particle(const IdealGas::Parameters& p) : c(p) {}
  /// A step that multiplies the lengths by 1 + x, 1 + y and 1 + z.
  void stretch(double x, double y, double z, double dt) {
    const double heat =
        IdealGas::advance(c, Mat<3, T>{{T(x / dt), 0, 0, 0, T(y / dt), 0, 0, 0, T(z / dt)}}, T(dt), state);
    CHECK(heat == 0);
  }
  /// Steps of the same length in time and in ln J to the volume ratio J, along x.
  void to(double J, int steps, double time) {
    const double ratio = std::exp((std::log(J) - double(state.log_volume_ratio)) / steps);
    for (int k = 0; k < steps; ++k) stretch(ratio - 1, 0, 0, time / steps);
  }
  /// What the gas presses with above p0, and the viscosity with it, Pa.
  double pressure() const { return -double(IdealGas::kirchhoff_stress(c, state).s[0]) / J(); }
  double J() const { return double(IdealGas::volume_ratio(state)); }
  double energy() const { return double(IdealGas::stored_energy(c, state)); }
  double speed() const { return double(IdealGas::wave_speed(c, state)); }

  IdealGas::Constants<T> c;
  IdealGas::State<3, T> state{};
};

}  // namespace

TEST_CASE(
    "ideal_gas: without viscosity p J^g is kept by steps of any length, and the energy is the work of the pressure") {
  for (const double J : {1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999999, 1.000001, 1.5, 20.0, 1e6})
    for (const int steps : {1, 7}) {
      CAPTURE(J, steps);
      Particle<> gas(air(0, 0));
      gas.to(J, steps, 1);
      CHECK(gas.state.heating == 0);
      CHECK(gas.pressure() == Approx(101325 * std::expm1(-1.4 * std::log(J))).epsilon(1e-8));
      // The work of p - p0 from 1 to J; near J = 1 half of g p0 (1 - J)^2, as the difference loses its digits.
      const double work = std::abs(J - 1) < 1e-5 ? 0.5 * 1.4 * 101325 * (J - 1) * (J - 1)
                                                 : 101325 * ((std::pow(J, -0.4) - 1) / 0.4 + J - 1);
      CHECK(gas.energy() == Approx(work).epsilon(1e-5));
    }
}

// With a quadratic viscosity alone and a steady rate J q = Q is steady, and a = Q/p0 (1 - J^(g - 1)).
TEST_CASE("ideal_gas: a steady compression heats as its viscosity works, at second order in the step") {
  const double J = 0.3, time = 5e-5, rate = -std::log(J) / time, Q = 1.2 * 2 * 1e-4 * rate * rate;
  const double a = Q / 101325 * (1 - std::pow(J, 0.4));
  double error[2];
  for (int fine = 0; fine < 2; ++fine) {
    Particle<> gas(air(2, 0));
    gas.state.shock_pressure = Q;  // as if it had gone on before
    gas.to(J, 50 << fine, time);
    CHECK(gas.state.shock_pressure == Approx(Q).epsilon(1e-9));
    error[fine] = gas.state.heating / a - 1;
    // The first law: internal energy, less what p0 has done, is the work of the pressure and of the viscosity.
    const double pressure_energy = 101325 * ((1 + a) * std::pow(J, -0.4) - 1) / 0.4 + 101325 * (J - 1);
    CHECK(gas.energy() == Approx(pressure_energy).epsilon(1e-4));
  }
  CHECK(std::abs(error[1]) < 1e-4);
  CHECK(error[0] / error[1] == Approx(4).epsilon(0.01));
}

TEST_CASE(
    "ideal_gas: the viscosity is rho (C2 (h d)^2 + C1 h c d) where the gas is compressed, and none where it expands") {
  Particle<> gas(air(3, 0.25));
  gas.to(0.5, 1, 1e9);  // so slowly that nothing heats
  CHECK(gas.state.heating < 1e-6);
  const double dt = 1e-5, c = std::sqrt(1.4 * 101325 / 1.2 * std::pow(0.5, -0.4)), change = -std::log(0.99),
               d = change / dt, density = 1.2 / 0.5 / 0.99;
  gas.stretch(-0.01, 0, 0, dt);
  const double q = density * (3 * 1e-4 * d * d + 0.25 * 0.01 * c * d);
  CHECK(gas.state.shock_pressure / gas.J() == Approx(q).epsilon(1e-6));
  CHECK(gas.pressure() == Approx(101325 * ((1 + gas.state.heating) * std::pow(0.495, -1.4) - 1) + q).epsilon(1e-9));
  const double hot = gas.state.heating;
  gas.stretch(0.02, 0, 0, dt);
  CHECK(gas.state.shock_pressure == 0);
  CHECK(gas.state.heating == hot);
}

TEST_CASE("ideal_gas: a shape that changes at one volume presses with nothing but p0, whatever the rate") {
  Particle<> gas(air());
  const double shear[9] = {0, 1e4, 0, 0, 0, 0, 0, 0, 0};
  Mat<3, double> L;
  for (int k = 0; k < 9; ++k) L.m[k] = shear[k];
  IdealGas::advance(gas.c, L, 1e-3, gas.state);
  CHECK(gas.pressure() == 0);
  for (int k = 0; k < 6; ++k) CHECK(IdealGas::kirchhoff_stress(gas.c, gas.state).s[k] == 0);
}

TEST_CASE("ideal_gas: its entropy never falls, and its pressure stays above nothing") {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> between(-0.3, 0.3);
  Particle<> gas(air());
  Particle<float> single(air());
  for (int k = 0; k < 20000; ++k) {
    const double before = gas.state.heating;
    // The volume is drawn back to 1, so that it wanders without end.
    const double x = between(random) - 0.1 * std::tanh(double(gas.state.log_volume_ratio));
    gas.stretch(x, 0, 0, 1e-2);
    single.stretch(x, 0, 0, 1e-2);
    REQUIRE(gas.state.heating >= before);
    REQUIRE(gas.pressure() + 101325 > 0);
    REQUIRE(gas.energy() >= 0);
    REQUIRE(std::isfinite(single.pressure()));
  }
  CHECK(gas.state.heating > 0);
}

// For strong shocks the density behind is (g + 1)/(g - 1) times that before: a front of steady rates that carries the
// momentum of the jump, tau = J (p0 - p - q) = -m^2 (1 - J) in units of m^2 = (mass flow)^2 over density.
TEST_CASE("ideal_gas: through a steady front it comes to the state of Rankine and Hugoniot") {
  for (const double mach : {1.5, 3.0, 20.0}) {
    CAPTURE(mach);
    const double g = 1.4, p0 = 101325, density = 1.2;
    const double squared = mach * mach, sound = std::sqrt(g * p0 / density), speed = mach * sound;
    const double J2 = ((g - 1) * squared + 2) / ((g + 1) * squared), p2 = p0 * (2 * g * squared - (g - 1)) / (g + 1);
    Particle<> gas(air(2, 0.5));
    // On the way of a particle through the front p - p0 + q = density speed^2 (1 - J): what viscosity there must be gives
    // the rate, and the rate the next volume.
    const double dt = 2e-8 / mach;
    gas.stretch(-1e-4, 0, 0, dt * 10);
    int steps = 0;
    for (; steps < 2000000; ++steps) {
      const double J = gas.J(), l = std::log(J);
      const double p = p0 * (1 + gas.state.heating) * std::pow(J, -g);
      const double q = density * speed * speed * (1 - J) - (p - p0);
      if (q < 1e-5 * p2) break;
      // q J = density (C2 h^2 d^2 + C1 h c d)
      const double c = std::sqrt(g * p0 / density * (1 + gas.state.heating) * std::exp(-(g - 1) * l));
      const double A = 2 * 1e-4, B = 0.5 * 0.01 * c, C = q * J / density;
      const double rate = (-B + std::sqrt(B * B + 4 * A * C)) / (2 * A);
      gas.stretch(std::exp(-rate * dt) - 1, 0, 0, dt);
    }
    CHECK(steps < 2000000);
    CHECK(gas.J() == Approx(J2).epsilon(1e-3));
    CHECK(p0 * (1 + gas.state.heating) * std::pow(gas.J(), -g) == Approx(p2).epsilon(1e-3));
  }
}

TEST_CASE("ideal_gas: sound, and the step that its viscosity leaves") {
  const double c = std::sqrt(1.4 * 101325 / 1.2);
  CHECK(Particle<>(air(2, 0)).speed() == Approx(c).epsilon(1e-12));
  // A step of h/(sqrt(3) v) with the reported speed v is the largest for a wave of k = 2 sqrt(3)/h whose velocity of the step
  // before is damped at the rate nu k^2: nu k^2 dt + (c k dt)^2/2 = 2.
  const auto left = [](double nu, double c, double speed) {
    const double k = 2 * std::sqrt(3.0) / 0.01, dt = 0.01 / (std::sqrt(3.0) * speed);
    return nu * k * k * dt + c * c * k * k * dt * dt / 2;
  };
  CHECK(left(0.5 * 0.01 * c, c, Particle<>(air()).speed()) == Approx(2).epsilon(1e-12));
  Particle<> gas(air(2, 0.5));
  gas.to(0.6, 100, 1e-3);
  const double d = std::log(1 / 0.6) / 1e-3, hot = c * std::sqrt((1 + gas.state.heating) * std::pow(0.6, -0.4));
  // The slope of q over density by the rate is C1 h c + 2 C2 h^2 d; c is that of the step's begin.
  CHECK(left(0.5 * 0.01 * hot + 4 * 1e-4 * d, hot, gas.speed()) == Approx(2).epsilon(3e-3));
}

TEST_CASE("ideal_gas: in plane strain z is held, around an axis it is strained too") {
  const IdealGas::Constants<double> c(air(0, 0));
  IdealGas::State<2, double> flat{}, ring{};
  IdealGas::advance(c, Mat<2, double>{{0.1, 0, 0, 0.1}}, 1.0, flat);
  IdealGas::advance(c, Deformation<2, double>{{{0.1, 0, 0, 0.1}}, 0.1}, 1.0, ring);
  CHECK(flat.log_volume_ratio == Approx(2 * std::log(1.1)).epsilon(1e-14));
  CHECK(ring.log_volume_ratio == Approx(3 * std::log(1.1)).epsilon(1e-14));
  const Sym<2, double> tau = IdealGas::kirchhoff_stress(c, flat);
  CHECK(tau.s[2] == tau.s[0]);
  CHECK(tau.s[0] > 0);
  CHECK(tau.s[3] == 0);
}
