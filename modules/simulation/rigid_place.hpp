#pragma once

#include "simulation/backend.hpp"

namespace mpm {

/// Where a place of now, m, was at the start, as a rigid body in this state has taken it with it.
Vector3 place_at_start(const RigidBodySpecification& body, const RigidState& state, const Vector3& x);

}  // namespace mpm
