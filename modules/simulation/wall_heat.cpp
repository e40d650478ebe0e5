#include "simulation/wall_heat.hpp"

#include <algorithm>
#include <cstdlib>

namespace mpm {

std::vector<double> wall_shares(const Experiment& experiment) {
  const mpm_shape& shape = experiment.shape.plugin->shape();
  if (shape.form == MPM_NODE_LIST) return {1.0};
  constexpr std::size_t n = MPM_LANES;
  const std::size_t width = shape.width;
  constexpr int wall = 4;  // any node
  const double half = 0.5 / experiment.bodies.front().particles_per_cell_axis;
  const std::vector<double> position(n, wall), half_size(n, half), domain(n, half);  // along one axis
  std::vector<std::int32_t> base(n);
  std::vector<double> offset(n), weight(width * n);
  mpm_shape_batch batch{};
  batch.count = batch.stride = n, batch.dimension = 1;
  batch.position = position.data(), batch.half_size = half_size.data(), batch.domain = domain.data();
  batch.base = base.data(), batch.offset = offset.data(), batch.weight = weight.data();
  shape.evaluate[MPM_SCALAR_DOUBLE](experiment.shape.parameters.data(), &batch);
  std::vector<double> shares;
  for (std::size_t k = 0; k < width; ++k) {
    const int inward = std::abs(base[0] + static_cast<int>(k) - wall);
    if (weight[k * n] == 0) continue;
    shares.resize(std::max<std::size_t>(shares.size(), static_cast<std::size_t>(inward) + 1));
    shares[static_cast<std::size_t>(inward)] += weight[k * n];
  }
  return shares;
}

}  // namespace mpm
