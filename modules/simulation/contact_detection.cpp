#include "simulation/contact_detection.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mpm {
namespace {
constexpr int offsets_per_cell = 256;
constexpr double reach_of_weights = 4;  // cells, which is beyond the support of every shape

/// Weights of a list, which has no axes: rows of 2-D particles, summed over the line of nodes at zero.
std::vector<double> list_weights(const Component& component, const Row& row, const std::vector<double>& rows) {
  const mpm_shape& shape = component.plugin->shape();
  const double half = row.half_side, semi_side = row.half_side * row.stretch;
  const std::size_t n = (rows.size() + MPM_LANES - 1) / MPM_LANES * MPM_LANES, capacity = shape.capacity[0];
  std::vector<double> position(2 * n, rows.empty() ? 0.0 : rows.back()), half_size(2 * n, half), domain(4 * n, 0.0),
      corners(8 * n), weight(capacity * n);
  std::vector<std::int32_t> count(n), node(capacity * 2 * n);
  std::copy(rows.begin(), rows.end(), position.begin());
  std::fill(position.begin() + static_cast<std::ptrdiff_t>(n), position.end(), half);
  for (const std::size_t diagonal : {0u, 3u})
    std::fill_n(domain.begin() + diagonal * n, n, diagonal == 0 ? semi_side : half);
  for (std::size_t k = 0; k < 8; ++k)
    std::fill_n(corners.begin() + static_cast<std::ptrdiff_t>(k * n), n,
                (k / 2 >> k % 2 & 1 ? 1 : -1) * (k % 2 == 0 ? semi_side : half));
  mpm_list_batch batch{};
  batch.count = batch.stride = static_cast<std::uint32_t>(n);
  batch.dimension = 2;
  batch.capacity = shape.capacity[0];
  batch.position = position.data();
  batch.half_size = half_size.data();
  batch.domain = domain.data();
  if (shape.sample_points[0] > 0) batch.samples = corners.data();
  batch.node_count = count.data();
  batch.node = node.data();
  batch.weight = weight.data();
  shape.evaluate_list[MPM_SCALAR_DOUBLE][0](component.parameters.data(), &batch);
  std::vector<double> at_node(rows.size(), 0.0);
  for (std::size_t p = 0; p < rows.size(); ++p)
    for (int k = 0; k < count[p]; ++k)
      if (node[(2 * k) * n + p] == 0) at_node[p] += weight[k * n + p];
  return at_node;
}

}  // namespace

std::vector<double> row_weights(const Component& component, const Row& row, const std::vector<double>& rows) {
  const mpm_shape& shape = component.plugin->shape();
  if (shape.form == MPM_NODE_LIST) return list_weights(component, row, rows);
  const std::size_t n = (rows.size() + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
  std::vector<double> position(n, rows.empty() ? 0.0 : rows.back()), offset(n), weight(n * shape.width);
  std::vector<std::int32_t> base(n);
  std::copy(rows.begin(), rows.end(), position.begin());
  const std::vector<double> half_size(n, row.half_side);
  const std::vector<double> domain(n, row.half_side * row.stretch);  // the 1-D domain is one semi-side
  mpm_shape_batch batch{};
  batch.count = batch.stride = static_cast<std::uint32_t>(n);
  batch.dimension = 1;
  batch.position = position.data();
  batch.half_size = half_size.data();
  batch.domain = domain.data();
  batch.base = base.data();
  batch.offset = offset.data();
  batch.weight = weight.data();
  shape.evaluate[MPM_SCALAR_DOUBLE](component.parameters.data(), &batch);
  std::vector<double> at_node(rows.size(), 0.0);
  for (std::size_t p = 0; p < rows.size(); ++p) {
    const int node = -base[p];  // position in the stencil of the node at zero
    if (node >= 0 && node < static_cast<int>(shape.width)) at_node[p] = weight[node * n + p];
  }
  return at_node;
}

EdgeModel::EdgeModel(const Component& shape, int particles_per_cell_axis)
    : shape_(shape), rows_per_cell_(particles_per_cell_axis) {
  if (particles_per_cell_axis < 1) throw std::invalid_argument("an edge model needs at least one particle row a cell");
  // The mean grows with the edge up to the node's full support; deeper edges cannot be told apart and count as the
  // deepest.
  double last = -std::numeric_limits<double>::infinity();
  for (int k = -static_cast<int>(reach_of_weights) * offsets_per_cell;
       k <= static_cast<int>(reach_of_weights) * offsets_per_cell; ++k) {
    const double edge = static_cast<double>(k) / offsets_per_cell, mean = mean_position(edge);
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

double EdgeModel::mean_position(double edge) const {
  const Row row{0.5 / rows_per_cell_};
  return mean_of_rows([&](const std::vector<double>& rows) { return row_weights(shape_, row, rows); }, edge, 1,
                      rows_per_cell_);
}

double EdgeModel::contact_offset(double edge) const {
  return -mean_position(-edge) - mean_position(edge);
}

std::vector<EdgeModel> edge_models(const Experiment& experiment) {
  std::vector<EdgeModel> models;
  const bool reads_edges = experiment.contact &&
                           !(experiment.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION) &&
                           (experiment.contact_detection->plugin->detection().traits & MPM_READS_EDGES);
  if (!reads_edges && experiment.rigid_bodies.empty()) return models;
  for (int field = 0; field < experiment.field_count; ++field) {
    int rows = 8;
    for (const BodySpecification& body : experiment.bodies)
      if (body.field == field) rows = std::min(rows, body.particles_per_cell_axis);
    models.emplace_back(experiment.shape, rows);
  }
  return models;
}

}  // namespace mpm
