#pragma once
// Where heat enters that comes through a wall.

#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// A shape's weights at a wall, folded there. Shapes that average over a particle's
/// domain, which no point of a wall has, count as the linear one that they average.
struct WallWeights {
  /// Of the node on the wall and the next ones inward: they share the heat that comes through the wall, and the
  /// temperature at the wall is their sum but for what the gradient there makes of the nodes beyond. They sum to 1.
  std::vector<double> shares;
  /// Twice the sum of weight times distance of the nodes beyond the wall, cells: where the temperature rises by g a cell
  /// inward, the wall is colder by this times g than the shares say.
  double beyond = 0;
};
WallWeights wall_weights(const Experiment& experiment);

}  // namespace mpm
