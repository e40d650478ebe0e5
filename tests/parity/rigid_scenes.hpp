// Scenes of tests/parity/parity.hpp with rigid bodies: a floor that tilts into both bodies and one that turns and is run
// into, each with a law of its own.
#pragma once

#include "parity/parity.hpp"
#include "support/larger.hpp"

namespace mpm::test {

inline Mix beside_rigid_bodies(int dimension) {
  Mix mix;
  mix.dimension = dimension;
  mix.more = dimension == 2 ? R"J(, "rigid_bodies": [
      {"name": "floor", "velocity": ["0.3*sin(9*t)", "0.5+t"], "contact": {"type": "coulomb", "friction": 0.3},
       "geometry": {"type": "half_space", "point": [0, 0.25], "normal": [-0.1, 1]}},
      {"name": "wheel", "velocity": [-0.5, 0], "angular_velocity": "3+20*t", "about": [0.9, 0.45],
       "geometry": {"type": "polygon", "points": [[0.84, 0.3], [1.1, 0.25], [1.1, 0.55], [0.83, 0.5]]},
       "contact": {"type": "velocity_dependent_friction", "friction": 0.2, "static_friction": 0.4, "decay_speed": 2}}])J"
                            : R"J(, "rigid_bodies": [
      {"name": "floor", "velocity": ["0.3*sin(9*t)", "0.5+t", 0.1], "contact": {"type": "coulomb", "friction": 0.3},
       "geometry": {"type": "half_space", "point": [0, 0.14, 0], "normal": [-0.1, 1, 0.05]}},
      {"name": "wheel", "velocity": [-0.5, 0, 0], "angular_velocity": [0.4, "3*t", 2],
       "geometry": {"type": "ball", "centre": [0.78, 0.27, 0.3], "radius": 0.15},
       "contact": {"type": "velocity_dependent_friction", "friction": 0.2, "static_friction": 0.4, "decay_speed": 2}}])J";
  return mix;
}

/// The largest difference of what two runs say of rigid bodies, over the size of their forces and ways.
inline double difference_at_rigid_bodies(const Backend& expected, const Backend& found, const Experiment& experiment) {
  double worst = 0, size = 0;
  for (std::size_t body = 0; body < experiment.rigid_bodies.size(); ++body) {
    const auto support = static_cast<std::size_t>(experiment.support_of_rigid_body(body));
    const Reaction &a = expected.reactions()[support], &b = found.reactions()[support];
    const RigidState &at_a = expected.rigid_bodies()[body], &at_b = found.rigid_bodies()[body];
    const auto compare = [&](const Vector3& x, const Vector3& y, bool counts) {
      for (std::size_t c = 0; c < 3; ++c) {
        worst = larger(worst, std::abs(x[c] - y[c]));
        if (counts) size = larger(size, std::abs(x[c]));
      }
    };
    compare(at_a.force_on(a), at_b.force_on(b), true);
    compare(at_a.torque_on(a), at_b.torque_on(b), true);
    compare(at_a.place, at_b.place, false);
    for (std::size_t row = 0; row < 3; ++row) compare(at_a.rotation[row], at_b.rotation[row], false);
  }
  return size > 0 ? worst / size : std::numeric_limits<double>::infinity();
}

}  // namespace mpm::test
