#pragma once
// Where heat enters that comes through a wall.

#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// A shape's weights at a wall, folded there. A shape that averages over a particle's domain is taken at a point, as no
/// point of a wall has a domain; those that list their nodes count as linear.
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
