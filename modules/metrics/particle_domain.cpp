#include "metrics/particle_domain.hpp"

namespace mpm {

const double* deformation_gradient(const BodyState& state, std::size_t p, int dimension) {
  const auto kept = state.material_state.find("deformation_gradient");
  if (kept == state.material_state.end()) return nullptr;
  const std::size_t particles = state.position.size() / static_cast<std::size_t>(dimension);
  return &kept->second[p * (kept->second.size() / particles)];
}

std::array<double, 9> semi_sides(const Experiment& experiment, int body, const BodyState& state, std::size_t p) {
  const auto D = static_cast<std::size_t>(experiment.dimension), corners = std::size_t{1} << D;
  const double half = 0.5 * experiment.grid.cell_size / experiment.bodies[body].particles_per_cell_axis;
  const double* F = deformation_gradient(state, p, experiment.dimension);
  std::array<double, 9> sides{};
  for (std::size_t i = 0; i < D; ++i)
    for (std::size_t a = 0; a < D; ++a) {
      double& side = sides[3 * i + a];
      if (!state.domain.empty())
        side = state.domain[(p * D + i) * D + a];
      else if (state.corners.empty())
        side = half * (F ? F[i * D + a] : i == a ? 1.0 : 0.0);
      else
        for (std::size_t c = 0; c < corners; ++c)
          side += (c >> a & 1 ? 1 : -1) * state.corners[(p * corners + c) * D + i] / static_cast<double>(corners);
    }
  return sides;
}

}  // namespace mpm
