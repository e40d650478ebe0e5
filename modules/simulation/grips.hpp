#pragma once
// What all backends share of grips: the velocity that a particle is told to have, and the sums of what it is given.

#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// The velocity that a grip gives a particle at x that began at X, m/s. Throws ImposedValueFailure where a component that
/// it holds is not finite.
Vector3 velocity_of(const Experiment& experiment, const Grip& grip, const Vector3& x, const Vector3& X, double time);

/// What a grip gives its particles after they have gathered from nodes, of which it may hold only some.
struct GivenToGripped {
  Vector3 impulse{}, moment{};  ///< kg m/s and kg m^2/s about the origin
  double energy = 0;            ///< J, by which their kinetic energy changes

  /// A particle of a mass, kg, at x comes to a velocity from another one, m/s.
  void add(double mass, const Vector3& x, const Vector3& from, const Vector3& to);
  void add(const GivenToGripped& other);
};

}  // namespace mpm
