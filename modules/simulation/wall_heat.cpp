#include "simulation/wall_heat.hpp"

#include <algorithm>
#include <cstdlib>

namespace mpm {

WallWeights wall_weights(const Experiment& experiment) {
  const mpm_shape& shape = experiment.shape.plugin->shape();
  const std::uint32_t needs = experiment.shape.plugin->descriptor->needs;
  if (shape.form == MPM_NODE_LIST || (needs & (MPM_NEEDS_HALF_SIZE | MPM_NEEDS_DOMAIN)) != 0) return {{1.0}, 0};
  constexpr std::size_t n = MPM_LANES;
  const std::size_t width = shape.width;
  constexpr int wall = 4;  // any node
  const std::vector<double> position(n, wall);
  std::vector<std::int32_t> base(n);
  std::vector<double> offset(n), weight(width * n);
  mpm_shape_batch batch{};
  batch.count = batch.stride = n, batch.dimension = 1;
  batch.position = position.data();
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
