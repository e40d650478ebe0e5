#pragma once
// The traction of contact on particles, which follows from the forces at the nodes where bodies meet.

#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

/// The traction on the particles of a body, Pa, three numbers each: the forces that contact gives its field at the touching
/// nodes of the particle's cell, over the areas of these nodes, both weighed with the tents of the grid. Forces of an even
/// pressure give that pressure, wherever the particle lies. Zero where no node of the cell touches.
std::vector<double> contact_traction(const Experiment& experiment, int body, const BodyState& state,
                                     const std::vector<ContactNode>& nodes);

}  // namespace mpm
