#pragma once
// Finds where the surface of a body is, seen from a node, by inverting a one-dimensional model of an edge near a node.

#include <vector>

#include "experiment/experiment.hpp"
#include "operators/contact_geometry.hpp"

namespace mpm {

/// A row of particles parallel to an edge.
struct Row {
  double half_side = 0.25;  ///< of the undeformed particle, cells
  double stretch = 1;       ///< how much longer the particle's domain has become across the edge
};
/// The weight of a node at zero for each of these places of rows, in cells.
std::vector<double> row_weights(const Component& shape, const Row& row, const std::vector<double>& places);

/// The mean place of a body's rows as a node at zero sees them, in cells: rows lie half a spacing and so on inside its face,
/// `stretch` / `per_cell` apart, and weights(places) weighs them. NaN where the node sees none.
template <class Weights>
double mean_of_rows(const Weights& weights, double face, double stretch, int per_cell) {
  constexpr double reach = 8;  // cells inside the face, which is beyond the support of every shape
  std::vector<double> rows;
  for (int k = 0; k * stretch < reach * per_cell; ++k) rows.push_back(face - (k + 0.5) * stretch / per_cell);
  const std::vector<double> w = weights(rows);
  double sum = 0, moment = 0;
  for (std::size_t p = 0; p < rows.size(); ++p) sum += w[p], moment += w[p] * rows[p];
  return moment / sum;
}

/// A body occupies x < e on one axis, and its particle rows lie 1/(2n), 3/(2n), ... cells inside the edge (n a cell). A
/// node at 0 sees the mass-weighted mean position of the rows in its support. That mean grows with e, so that it
/// determines e without a fitted constant. Positions and edges are in cells.
class EdgeModel {
 public:
  /// Throws std::invalid_argument for n < 1.
  EdgeModel(const Component& shape, int particles_per_cell_axis);

  /// The mean position of the rows for an edge at `edge`.
  double mean_position(double edge) const;
  /// The inverse: the edge that gives this mean. Means outside the model's range give its ends.
  double edge(double mean_position) const { return table().edge(mean_position); }
  /// The table of the inverse, which lives as long as the model.
  EdgeTable table() const { return {edges_.data(), means_.data(), static_cast<int>(edges_.size())}; }
  /// The distance between the means of two bodies that touch with their common edge at `edge`: the contact offset.
  double contact_offset(double edge) const;

 private:
  std::vector<double> edges_, means_;  ///< monotone table
  Component shape_;
  int rows_per_cell_;
};

/// Makes one model for each velocity field, and none where nobody reads them: a detection by edges, or a rigid body. The
/// rows of a field are those of its coarsest body, whose surface lags the most.
std::vector<EdgeModel> edge_models(const Experiment& experiment);

}  // namespace mpm
