#pragma once
// Where heat enters that comes through a wall.

#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// Shares of the heat through the area of a wall node that it and the next nodes inward take: the shape's weights at the
/// wall, mirrored there. They sum to 1. Shapes that list their nodes count as linear.
std::vector<double> wall_shares(const Experiment& experiment);

}  // namespace mpm
