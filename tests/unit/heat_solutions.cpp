// The exact solutions that scenes with temperature are held against, themselves held against published numbers, the
// heat equation and the balance of heat.
#include "support/heat_solutions.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace mpm::test;

namespace {

constexpr ConductingPhase ice{2.22, 2090, 917}, water{0.556, 4200, 917}, metal{40, 500, 8000};
constexpr double hour = 3600;  ///< s

StefanProblem freezing(double start) {
  return {ice, water, 334000, 263.15, 273.15, start};
}

/// The problem of one phase alone, beginning at its melting temperature.
StefanProblem one_phase(double stefan_number) {
  const ConductingPhase unit{1, 1, 1};
  return {unit, unit, 1 / stefan_number, 1, 0, 0};
}

template <class Solution>
double slope(const Solution& solution, double x, double t, double step) {
  return (solution.temperature(x + step, t) - solution.temperature(x - step, t)) / (2 * step);
}

/// The residual dT/dt - alpha d2T/dx2 over the largest of the two, by central differences.
template <class Solution>
double heat_equation_residual(const Solution& s, double diffusivity, double x, double t, double dx, double dt) {
  const double rate = (s.temperature(x, t + dt) - s.temperature(x, t - dt)) / (2 * dt);
  const double bend = (s.temperature(x + dx, t) - 2 * s.temperature(x, t) + s.temperature(x - dx, t)) / (dx * dx);
  return std::abs(rate - diffusivity * bend) / std::max(std::abs(rate), diffusivity * std::abs(bend));
}

}  // namespace

TEST_CASE("Stefan's problem of one phase has the lambdas of the literature", "[heat]") {
  // The values are those of Alexiades & Solomon (1993), Mathematical Modeling of Melting and Freezing Processes; here
  // to six digits from lambda exp(lambda^2) erf(lambda) = St / sqrt(pi) in 30 digits by mpmath.
  CHECK(one_phase(0.05).lambda() == Approx(0.156820922335).epsilon(1e-11));
  CHECK(one_phase(0.1).lambda() == Approx(0.220016272743).epsilon(1e-11));
  CHECK(one_phase(0.5).lambda() == Approx(0.464785920646).epsilon(1e-11));
  CHECK(one_phase(1).lambda() == Approx(0.620062633314).epsilon(1e-11));
  CHECK(one_phase(0.1).stefan_number() == Approx(0.1));
}

TEST_CASE("freezing water has Neumann's front", "[heat]") {
  const StefanProblem warm = freezing(283.15), at_melting = freezing(273.15);
  CHECK(warm.lambda() == Approx(0.157087599591).epsilon(1e-11));
  CHECK(warm.front(hour) == Approx(0.02028812097).epsilon(1e-9));
  CHECK(warm.temperature(0.01, hour) == Approx(268.109655792).epsilon(1e-11));
  CHECK(warm.temperature(0.05, hour) == Approx(280.864640962).epsilon(1e-11));
  CHECK(at_melting.lambda() == Approx(0.175080729334).epsilon(1e-11));
  CHECK(at_melting.front(hour) == Approx(0.02261196317).epsilon(1e-9));
  CHECK(at_melting.temperature(0.05, hour) == 273.15);
}

TEST_CASE("Neumann's solution conducts, and its front takes the latent heat", "[heat]") {
  const StefanProblem melting{water, ice, 334000, 293.15, 273.15, 263.15};
  for (const StefanProblem& problem : {freezing(283.15), melting}) {
    const double front = problem.front(hour), at_wall = problem.at_wall.diffusivity();
    CHECK(problem.temperature(0, hour) == Approx(problem.wall).epsilon(1e-14));
    CHECK(problem.temperature(0.999999 * front, hour) == Approx(problem.melting).epsilon(1e-6));
    CHECK(problem.temperature(1.000001 * front, hour) == Approx(problem.melting).epsilon(1e-6));
    CHECK(problem.temperature(100 * front, hour) == Approx(problem.start).epsilon(1e-12));
    CHECK(heat_equation_residual(problem, at_wall, 0.5 * front, hour, 1e-3 * front, 1) < 1e-4);
    CHECK(heat_equation_residual(problem, problem.beyond.diffusivity(), 2 * front, hour, 1e-3 * front, 1) < 1e-4);
    const double step = 1e-4 * front;
    const double arriving = problem.at_wall.conductivity * slope(problem, front - 2 * step, hour, step) -
                            problem.beyond.conductivity * slope(problem, front + 2 * step, hour, step);
    const double speed = (problem.front(hour + 1) - problem.front(hour - 1)) / 2;
    const double released = problem.at_wall.density * problem.latent_heat * speed;
    CHECK(std::abs(arriving) == Approx(released).epsilon(2e-3));
  }
}

TEST_CASE("slabs conduct, and their ends are what they say", "[heat]") {
  const double length = 0.1, t = 20, step = 1e-5, a = metal.diffusivity(), k = metal.conductivity;
  const SlabOfFixedEnds fixed{metal, length, 300, 350, 40, 1};
  CHECK(fixed.temperature(0, t) == Approx(300).epsilon(1e-14));
  CHECK(fixed.temperature(length, t) == Approx(350).epsilon(1e-14));
  CHECK(fixed.temperature(0.5 * length, 0) == Approx(365).epsilon(1e-14));
  CHECK(heat_equation_residual(fixed, a, 0.3 * length, t, 1e-4, 1e-2) < 1e-5);

  const SlabOfFlux flux{metal, length, 5000, 300, 20, 2};
  CHECK(-k * slope(flux, 0, t, step) == Approx(5000).epsilon(1e-6));
  CHECK(std::abs(k * slope(flux, length, t, step)) < 1e-2);
  CHECK(heat_equation_residual(flux, a, 0.3 * length, t, 1e-4, 1e-2) < 1e-5);

  const SlabOfConvection convection{metal, length, 800, 280, 60};
  CHECK(convection.root() == Approx(1.07687398631).epsilon(1e-11));  // Carslaw & Jaeger, table of tan: 1.0769 for 2
  CHECK(-k * slope(convection, 0, t, step) == Approx(800 * (280 - convection.temperature(0, t))).epsilon(1e-6));
  CHECK(std::abs(k * slope(convection, length, t, step)) < 1e-2);
  CHECK(heat_equation_residual(convection, a, 0.3 * length, t, 1e-4, 1e-2) < 1e-5);
}

TEST_CASE("plastic work in shear is the work less what is stored", "[heat]") {
  const double mu = 1e9, yield = 1e6, hardening = 2e8;
  CHECK(plastic_work_in_shear(yield / (std::sqrt(3.0) * mu), mu, yield, hardening) == 0);
  // With perfect plasticity tau = yield / sqrt(3) acts over the shear that is not elastic.
  CHECK(plastic_work_in_shear(0.1, mu, yield, 0) == Approx(1e6 / std::sqrt(3.0) * (0.1 - 1e-3 / std::sqrt(3.0))));
  // The stress is followed step by step and its work summed: half of the hardening part and all that is stored
  // elastically come off.
  double plastic = 0, dissipated = 0, work = 0, stress = 0;
  const double step = 1e-6;
  for (double shear = step; shear < 0.1 + 0.5 * step; shear += step) {
    const double trial = mu * (shear - std::sqrt(3.0) * plastic);
    const double over = std::sqrt(3.0) * trial - yield - hardening * plastic;
    const double flow = std::max(0.0, over / (3 * mu + hardening));
    plastic += flow;
    dissipated += (yield + hardening * plastic) * flow;
    const double now = trial - std::sqrt(3.0) * mu * flow;
    work += 0.5 * (stress + now) * step;
    stress = now;
  }
  CHECK(plastic_work_in_shear(0.1, mu, yield, hardening) == Approx(dissipated).epsilon(1e-4));
  CHECK(plastic_work_in_shear(0.1, mu, yield, hardening) == Approx(work - 0.5 * stress * stress / mu).epsilon(1e-4));
}
