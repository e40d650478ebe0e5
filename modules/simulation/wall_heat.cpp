#include "simulation/wall_heat.hpp"

#include <algorithm>
#include <cstdlib>

namespace mpm {

WallWeights wall_weights(const Experiment& experiment) {
  const mpm_shape& shape = experiment.shape.plugin->shape();
  if (shape.form == MPM_NODE_LIST) return {{1.0}, 0};
  constexpr std::size_t n = MPM_LANES;
  const std::size_t width = shape.width;
  constexpr int wall = 4;         // node of the wall, which may be any
  constexpr double point = 1e-6;  // half the size of a domain that is small enough to count as a point
  const std::vector<double> position(n, wall), half_size(n, point), domain(n, point);
  std::vector<std::int32_t> base(n);
  std::vector<double> offset(n), weight(width * n);
  mpm_shape_batch batch{};
  batch.count = batch.stride = n, batch.dimension = 1;
  batch.position = position.data(), batch.half_size = half_size.data(), batch.domain = domain.data();
  batch.base = base.data(), batch.offset = offset.data(), batch.weight = weight.data();
  shape.evaluate[MPM_SCALAR_DOUBLE](experiment.shape.parameters.data(), &batch);
  WallWeights result;
  for (std::size_t k = 0; k < width; ++k) {
    const int inward = base[0] + static_cast<int>(k) - wall;
    const double w = weight[k * n];
    if (w == 0) continue;
    const std::size_t node = static_cast<std::size_t>(std::abs(inward));
    result.shares.resize(std::max(result.shares.size(), node + 1));
    result.shares[node] += w;
    if (inward < 0) result.beyond += 2 * w * static_cast<double>(node);
  }
  return result;
}

}  // namespace mpm
