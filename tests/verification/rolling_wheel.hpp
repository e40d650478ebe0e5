#pragma once
// A solid cylinder on an incline of 30 degrees, and how fast it gathers speed and spin.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "support/scene.hpp"

namespace mpm::test::rolling_wheel {

constexpr double g = 9.81, radius = 0.5;
inline const double sine = 0.5, cosine = std::sqrt(3.0) / 2;

/// The weight grows over many periods in which the wheel swings on its contact; let go of at once it bounces.
inline const char* wheel = R"J({
  "dimension": 2,
  "grid": {"cell_size": 0.05, "domain": [[0, -0.4], [2.4, 1.2]],
           "boundaries": {"x_min": "free", "x_max": "free", "y_min": "stick", "y_max": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"}, "contact": {"type": "coulomb", "friction": 0.5},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 2e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "ground", "material": "m", "geometry": {"type": "box", "lower": [0, -0.4], "upper": [2.4, 0]}},
    {"name": "wheel", "material": "m", "geometry": {"type": "ball", "centre": [0.7, 0.5], "radius": 0.5}}],
  "body_force": ["4.905*(0.5*(1-cos(pi*t/0.4))*(t<0.4)+(t>=0.4))", "-8.495709211*(0.5*(1-cos(pi*t/0.4))*(t<0.4)+(t>=0.4))"],
  "solver": {"end_time": 0.9}, "output": {"ledger": false}})J";

/// Slopes of the least-squares lines, from the full weight on, through the wheel's velocity along the slope and through the
/// speed of its rim, m/s^2.
struct Rolling {
  double acceleration = 0, spin_up = 0;
};

/// Speed of the rim: angular momentum about the centre of mass over that of a solid cylinder, m R^2 / 2, times R.
inline std::pair<double, double> speeds(const BodyState& state) {
  const std::size_t count = state.position.size() / 2;
  double x[2]{}, v[2]{}, spin = 0;
  for (std::size_t k = 0; k < 2 * count; ++k) {
    x[k % 2] += state.position[k] / static_cast<double>(count);
    v[k % 2] += state.velocity[k] / static_cast<double>(count);
  }
  for (std::size_t p = 0; p < count; ++p)
    spin += (state.position[2 * p] - x[0]) * state.velocity[2 * p + 1] -
            (state.position[2 * p + 1] - x[1]) * state.velocity[2 * p];
  return {v[0], -spin / static_cast<double>(count) / (0.5 * radius)};
}

inline double slope(const std::vector<double>& t, const std::vector<double>& y) {
  double mean_t = 0, mean_y = 0, above = 0, below = 0;
  for (std::size_t k = 0; k < t.size(); ++k)
    mean_t += t[k] / static_cast<double>(t.size()), mean_y += y[k] / static_cast<double>(t.size());
  for (std::size_t k = 0; k < t.size(); ++k)
    above += (t[k] - mean_t) * (y[k] - mean_y), below += (t[k] - mean_t) * (t[k] - mean_t);
  return above / below;
}

inline Rolling roll(const std::vector<std::string>& settings, int body = 1) {
  Scene scene(wheel, settings);
  std::vector<double> times, velocities, rims;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.time() < 0.4 || scene.simulation.steps() % 20 != 0) continue;
    const auto [velocity, rim] = speeds(scene.body(body));
    times.push_back(scene.simulation.time()), velocities.push_back(velocity), rims.push_back(rim);
  }
  return {slope(times, velocities), slope(times, rims)};
}

/// The settings of a grid of such cells with so many particles a cell and axis.
inline std::vector<std::string> grid(const std::string& cell, const std::string& particles) {
  return {set("/grid/cell_size", cell), set("/bodies/0/particles_per_cell_axis", particles),
          set("/bodies/1/particles_per_cell_axis", particles)};
}

}  // namespace mpm::test::rolling_wheel
