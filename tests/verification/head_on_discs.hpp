#pragma once
// Two discs that collide head-on in one velocity field, and how fast their centres part.

#include <cmath>

#include "support/scene.hpp"

namespace mpm::test {

inline constexpr const char* head_on_discs = R"J({
  "title": "two discs", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.025, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "separate"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "lower", "material": "m", "geometry": {"type": "ball", "centre": [0.2, 0.2], "radius": 0.2}, "velocity": [0.1, 0.1]},
    {"name": "upper", "material": "m", "geometry": {"type": "ball", "centre": [0.8, 0.8], "radius": 0.2}, "velocity": [-0.1, -0.1]}],
  "solver": {"time_step": 0.001, "end_time": 3.5}})J";

/// The mean place and velocity of a body of equal particles.
struct Centre {
  double place[2] = {}, velocity[2] = {};
};

inline Centre centre_of(const BodyState& state) {
  Centre mean;
  const double count = static_cast<double>(state.position.size()) / 2;
  for (std::size_t k = 0; k < state.position.size(); ++k) {
    mean.place[k % 2] += state.position[k] / count;
    mean.velocity[k % 2] += state.velocity[k] / count;
  }
  return mean;
}

/// How far the centres of mass of two bodies are apart, m, and how fast that grows, m/s.
struct Approach {
  double distance = 0, rate = 0;
};

inline Approach approach_of(const Scene& scene) {
  const Centre a = centre_of(scene.body(0)), b = centre_of(scene.body(1));
  const double dx = b.place[0] - a.place[0], dy = b.place[1] - a.place[1], distance = std::hypot(dx, dy);
  return {distance, ((b.velocity[0] - a.velocity[0]) * dx + (b.velocity[1] - a.velocity[1]) * dy) / distance};
}

}  // namespace mpm::test
