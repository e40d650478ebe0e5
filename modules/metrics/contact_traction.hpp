#pragma once
// The traction of contact on particles, which follows from the forces at the nodes where bodies meet.

#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

/// The traction on the particles of a body, Pa, three numbers each, where a node of the particle's cell touches another
/// body, else zero: the forces that contact gives its field at the touching nodes up to two cells around the node nearest to
/// the particle, over the area of these nodes. Splines spread a face over up to four rows of nodes, whose shares of the
/// force and of the area are unlike: only their sums make a traction (operators/contact.hpp).
std::vector<double> contact_traction(const Experiment& experiment, int body, const BodyState& state,
                                     const std::vector<ContactNode>& nodes);

}  // namespace mpm
