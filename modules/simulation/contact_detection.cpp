#include "simulation/contact_detection.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mpm {
namespace {
constexpr int samples_per_cell = 256;
constexpr double reach = 4;  // cells: beyond the support of every shape
}  // namespace

EdgeModel::EdgeModel(const Component& shape, int particles_per_cell_axis)
    : shape_(shape), rows_per_cell_(particles_per_cell_axis) {
  if (particles_per_cell_axis < 1) throw std::invalid_argument("an edge model needs at least one particle row a cell");
  // The mean grows with the edge up to the node's full support; deeper edges cannot be told apart and count as the
  // deepest.
  double last = -std::numeric_limits<double>::infinity();
  for (int k = -static_cast<int>(reach) * samples_per_cell; k <= static_cast<int>(reach) * samples_per_cell; ++k) {
    const double edge = static_cast<double>(k) / samples_per_cell, mean = mean_position(edge);
    if (!std::isfinite(mean)) continue;
    if (mean <= last) {
      if (edge > 0.5) break;
      continue;
    }
    edges_.push_back(edge);
    means_.push_back(mean);
    last = mean;
  }
  if (edges_.size() < 2) throw std::invalid_argument("the shape has no support to build an edge model from");
}

std::vector<double> EdgeModel::weights(const std::vector<double>& rows) const {
  const mpm_shape& shape = shape_.plugin->shape();
  const std::size_t n = (rows.size() + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
  std::vector<double> position(n, rows.empty() ? 0.0 : rows.back()), offset(n), weight(n * shape.width);
  std::vector<std::int32_t> base(n);
  std::copy(rows.begin(), rows.end(), position.begin());
  std::vector<double> half_size(n, 0.5 / rows_per_cell_);
  const mpm_shape_batch batch{static_cast<std::uint32_t>(n),
                              static_cast<std::uint32_t>(n),
                              1,
                              0,
                              position.data(),
                              half_size.data(),
                              base.data(),
                              offset.data(),
                              weight.data(),
                              nullptr};
  shape.evaluate[MPM_SCALAR_DOUBLE](shape_.parameters.data(), &batch);
  std::vector<double> at_node(rows.size(), 0.0);
  for (std::size_t p = 0; p < rows.size(); ++p) {
    const int node = -base[p];  // position in the stencil of the node at zero
    if (node >= 0 && node < static_cast<int>(shape.width)) at_node[p] = weight[node * n + p];
  }
  return at_node;
}

double EdgeModel::mean_position(double edge) const {
  std::vector<double> rows;
  for (int k = 0; k < 2 * static_cast<int>(reach) * rows_per_cell_; ++k)
    rows.push_back(edge - (k + 0.5) / rows_per_cell_);
  const std::vector<double> w = weights(rows);
  double sum = 0, moment = 0;
  for (std::size_t p = 0; p < rows.size(); ++p) sum += w[p], moment += w[p] * rows[p];
  return moment / sum;
}

double EdgeModel::edge(double mean) const {
  if (mean <= means_.front()) return edges_.front();
  if (mean >= means_.back()) return edges_.back();
  const auto upper = std::upper_bound(means_.begin(), means_.end(), mean) - means_.begin();
  const double share = (mean - means_[upper - 1]) / (means_[upper] - means_[upper - 1]);
  return edges_[upper - 1] + share * (edges_[upper] - edges_[upper - 1]);
}

double EdgeModel::contact_offset(double edge) const {
  return -mean_position(-edge) - mean_position(edge);
}

}  // namespace mpm
