#pragma once
// Finds the nodes that share the heat which comes through a wall.

#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// A shape's weights at a wall, folded there. A shape that averages over a particle's domain is evaluated at a point,
/// as a point of a wall has no domain; shapes that list their nodes count as linear.
struct WallWeights {
  /// How the wall's node and the next ones inward share heat that comes through the wall; the shares sum to 1. Weighted
  /// by them the temperatures sum to that of the wall, but for what the gradient there makes of the nodes beyond.
  std::vector<double> shares;
  /// Twice the sum of weight times distance of the nodes beyond the wall, cells: where the temperature rises by g a
  /// cell inward, the wall is colder by this times g than the shares give.
  double beyond = 0;
};
WallWeights wall_weights(const Experiment& experiment);

}  // namespace mpm
