#include "simulation/grips.hpp"

#include <cmath>

#include "operators/supports.hpp"
#include "simulation/imposed_value.hpp"

namespace mpm {

Vector3 velocity_of(const Experiment& experiment, const Grip& grip, const Vector3& x, const Vector3& X, double time) {
  const Vector3 velocity = grip.velocity(x, X, time);
  for (std::size_t c = 0; c < 3; ++c)
    if (grip.held[c] && !std::isfinite(velocity[c]))
      if (auto found =
              impossible_velocity(experiment, grip.velocity, grip.pointer + "/velocity", grip.held, x, X, time))
        throw ImposedValueFailure(experiment, std::move(*found));
  return velocity;
}

void GivenToGripped::add(double mass, const Vector3& x, const Vector3& from, const Vector3& to) {
  add_given_to_particle(impulse.data(), moment.data(), energy, mass, x.data(), from.data(), to.data());
}

void GivenToGripped::add(const GivenToGripped& other) {
  for (std::size_t c = 0; c < 3; ++c) impulse[c] += other.impulse[c], moment[c] += other.moment[c];
  energy += other.energy;
}

}  // namespace mpm
