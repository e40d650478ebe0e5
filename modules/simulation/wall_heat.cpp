#include "simulation/wall_heat.hpp"

#include <algorithm>

namespace mpm {

std::vector<double> wall_shares(const Experiment& experiment) {
  const mpm_shape& shape = experiment.shape.plugin->shape();
  if (shape.form == MPM_NODE_LIST) return {1.0};
  constexpr std::size_t lanes = MPM_LANES;
  const std::size_t D = static_cast<std::size_t>(experiment.dimension), width = shape.width;
  const double half = 0.5 / experiment.bodies.front().particles_per_cell_axis;
  constexpr double wall = 4;  // any node
  std::vector<double> position(D * lanes, wall), half_size(D * lanes, half), domain(D * D * lanes, 0.0);
  for (std::size_t a = 0; a < D; ++a) std::fill_n(domain.begin() + (a * D + a) * lanes, lanes, half);
  std::vector<std::int32_t> base(D * lanes);
  std::vector<double> offset(D * lanes), weight(D * width * lanes), moment(D * lanes);
  const std::uint32_t needs = experiment.shape.plugin->descriptor->needs;
  mpm_shape_batch batch{};
  batch.count = batch.stride = lanes, batch.dimension = static_cast<std::uint32_t>(D);
  batch.position = position.data();
  batch.half_size = needs & MPM_NEEDS_HALF_SIZE ? half_size.data() : nullptr;
  batch.domain = needs & MPM_NEEDS_DOMAIN ? domain.data() : nullptr;
  batch.base = base.data(), batch.offset = offset.data(), batch.weight = weight.data();
  shape.evaluate[MPM_LANES_DOUBLE](experiment.shape.parameters.data(), &batch);
  std::vector<double> shares;
  for (std::size_t k = 0; k < width; ++k) {
    const int inward = std::abs(base[0] + static_cast<int>(k) - static_cast<int>(wall));
    if (weight[k * lanes] == 0) continue;
    shares.resize(std::max<std::size_t>(shares.size(), static_cast<std::size_t>(inward) + 1));
    shares[static_cast<std::size_t>(inward)] += weight[k * lanes];
  }
  return shares;
}

}  // namespace mpm
