#pragma once
// The edges of rigid bodies as pictures show them.

#include <utility>
#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

/// The edge of a rigid body in 2-D where it is, m, in pieces of half a cell at most; of what has no bound, around the domain.
std::vector<std::pair<Vector3, Vector3>> edges_of(const Experiment& experiment, std::size_t body,
                                                  const RigidState& state);

}  // namespace mpm
