#pragma once
// A disc that spins once a second, and what is kept of its spin in a turn.

#include <cstdio>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/scene.hpp"

namespace mpm::test {

/// The disc has 20 cells a diameter and turns once a second; density (omega R)^2 / E = 1e-4.
inline constexpr const char* spinning_disc = R"J({
  "dimension": 2, "constants": {"w": 6.283185307179586},
  "grid": {"cell_size": 0.05, "domain": [[-0.8, -0.8], [0.8, 0.8]], "boundaries": {"all": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 9.869604401e7, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "body", "material": "m", "velocity": ["-w*y", "w*x"],
              "geometry": {"type": "ball", "centre": [0, 0], "radius": 0.5}}],
  "solver": {"time_step": "auto", "courant": 0.8, "end_time": 1}, "output": {"ledger": false},
  "compare": {"exact": {"type": "rigid_rotation", "angular_velocity": 6.283185307179586, "centre_x": 0, "centre_y": 0}}})J";

/// Settings of a softer disc in steps half as long.
inline std::vector<std::string> soft_turn(std::vector<std::string> settings) {
  settings.push_back(set("/materials/m/youngs_modulus", "9.869604401e6"));
  settings.push_back(set("/solver/courant", "0.4"));
  return settings;
}

/// Prints what a turn keeps, and returns the share of the spin.
inline double turn(const std::string& name, const std::vector<std::string>& settings) {
  Scene scene(spinning_disc, settings);
  const Totals start = scene.metrics.initial(), end = scene.run();
  const double spin = end.angular_momentum[2] / start.angular_momentum[2];
  std::printf("  %-12s %.12f %.6f %.4f\n", name.c_str(), spin, end.kinetic / start.kinetic, end.position_error_rms);
  return spin;
}

}  // namespace mpm::test
