#pragma once
// Two bars, and two planks, with a compliant layer between them.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "support/larger.hpp"
#include "support/scene.hpp"

namespace mpm::test::interfaces {

/// The root in (0, pi/2) of x tan(x) = 2 r: the phase over a bar's length of the mode in which two equal bars swing
/// against one another on a spring of D L / E = r.
inline double phase_over_length(double r) {
  double low = 0, high = std::numbers::pi / 2;
  for (int k = 0; k < 80; ++k) {
    const double x = (low + high) / 2;
    (x * std::tan(x) < 2 * r ? low : high) = x;
  }
  return low;
}

constexpr double modulus = 1e6, density = 1000;

/// Two bars in the symmetric mode of their length, 0.25 m, and of their thickness, 0.1 m, with Poisson's ratio 0.
struct Bars {
  double length, stiffness, wave_number, frequency;
  std::string text;
};

inline std::string number(double value) {
  return digits(value);
}

/// Along the bars: they open and close. D L / E = `ratio`.
inline Bars opening(double ratio, double amplitude = 1e-4) {
  const double L = 0.25, k = phase_over_length(ratio) / L;
  Bars bars{L, ratio * modulus / L, k, k * std::sqrt(modulus / density), {}};
  const std::string v = number(amplitude), phase = number(k);
  bars.text = R"J({
  "title": "two bars on a spring", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.05, "domain": [[-0.2, 0], [0.7, 0.1]], "boundaries": {"all": "free", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
  "contact": {"type": "linear_interface", "normal_stiffness": )J" +
              number(bars.stiffness) + R"J(, "shear_stiffness": 0},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 1000}},
  "bodies": [
    {"name": "left", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.25, 0.1]},
     "velocity": [")J" +
              v + "*cos(" + phase + R"J(*x)", 0]},
    {"name": "right", "material": "m", "geometry": {"type": "box", "lower": [0.25, 0], "upper": [0.5, 0.1]},
     "velocity": ["-)J" +
              v + "*cos(" + phase + R"J(*(0.5-x))", 0]}],
  "solver": {"time_step": "auto", "courant": 0.2, "end_time": 1}, "output": {"ledger": true}})J";
  return bars;
}

/// The velocity of a body's middle along x, m/s.
inline double velocity_along(const Scene& scene, int body) {
  const BodyState state = scene.body(body);
  double sum = 0;
  for (std::size_t p = 0; p < state.velocity.size(); p += 2) sum += state.velocity[p];
  return 2 * sum / static_cast<double>(state.velocity.size());
}

/// The share by which the bars swing too slowly, from the phase in which they are after a period and a quarter.
inline double slowness(const Bars& bars, std::vector<std::string> settings) {
  const double turns = 1.25;
  settings.push_back(set("/solver/end_time", digits(turns * 2 * std::numbers::pi / bars.frequency)));
  Scene scene(bars.text, settings);
  const double start = velocity_along(scene, 0) - velocity_along(scene, 1);
  scene.run();
  const double end = velocity_along(scene, 0) - velocity_along(scene, 1);
  return std::asin(std::clamp(end / start, -1.0, 1.0)) / (turns * 2 * std::numbers::pi);
}

/// What the tip of the planks should sink by, m, with a layer of the shear stiffness K.
inline double exact_tip(double K) {
  const double L = 1, t = 0.1, E = 1e6, q = 1000 * 0.05 * 2 * t, EI = 2 * E * t * t * t / 12;
  const double squared = K * (t * t / EI + 2 / (E * t)), a = std::sqrt(squared), A = K * t * q / (2 * EI * squared);
  const double coupled = L * L * L * L / 4 - L * L / squared + 2 * L * std::tanh(a * L) / (a * squared) -
                         2 * (1 - 1 / std::cosh(a * L)) / (squared * squared);
  const double joined = K > 0 ? t * A * coupled : 0;
  return (q * L * L * L * L / 8 - joined) / EI + q * L * L / (2 * 5.0 / 6 * E / 2 * 2 * t);
}

inline BodyState lower_plank(const std::vector<std::string>& overrides) {
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.overrides = overrides;
  const Experiment planks =
      read_experiment(std::filesystem::path(MPM_SOURCE_DIR) / "experiments/studies/two_planks.json",
                      ComponentLookup(plugins()), options);
  Simulation simulation(planks, backend_factory(1));
  while (!simulation.finished()) simulation.step();
  return simulation.backend().body_state(0);
}

/// How far the particles at the lower plank's end have sunk, m.
inline double tip_of(const BodyState& lower) {
  double tip = 0, farthest = 0;
  for (std::size_t k = 0; k < lower.position.size(); k += 2) farthest = larger(farthest, lower.initial_position[k]);
  int count = 0;
  for (std::size_t k = 0; k < lower.position.size(); k += 2)
    if (lower.initial_position[k] > farthest - 1e-9)
      tip += lower.initial_position[k + 1] - lower.position[k + 1], ++count;
  return tip / count;
}

/// The same of the particle that the scene's probe follows.
inline double probed(const BodyState& lower) {
  double nearest = 1, sunk = 0;
  for (std::size_t k = 0; k < lower.position.size(); k += 2) {
    const double away = std::hypot(lower.initial_position[k] - 0.99, lower.initial_position[k + 1] - 0.09);
    if (away < nearest) nearest = away, sunk = lower.initial_position[k + 1] - lower.position[k + 1];
  }
  return sunk;
}

}  // namespace mpm::test::interfaces
