#pragma once
// The nodes where bodies meet, as a frame shows them and a table beside it lists them.

#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "render/frame.hpp"
#include "simulation/backend.hpp"

namespace mpm::app {

/// A row a node: place (m), names of both fields, what it does (apart, sticks, slips), the unit normal from the first to
/// the second field, separation (m, negative where they overlap), area (m^2; m in 2-D) and force on the first field (N;
/// N/m in plane strain).
std::string contact_table(const Experiment& experiment, const std::vector<ContactNode>& nodes);

/// The marks of a 2-D frame.
std::vector<render::NodeMark> contact_marks(const Experiment& experiment, const std::vector<ContactNode>& nodes);

}  // namespace mpm::app
