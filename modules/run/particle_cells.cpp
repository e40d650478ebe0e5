#include "run/particle_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm::app {
namespace {

/// Half the width of what a particle's shape reaches, in cells. A list of nodes reaches a cell beyond the domain.
double reach_of(const mpm_shape& shape) {
  return shape.form == MPM_NODE_LIST ? 1.5 : 0.5 * shape.width;
}

}  // namespace

std::size_t ParticleCells::Hash::operator()(const Key& key) const {
  std::uint64_t hash = 0;
  for (const std::int32_t part : key) hash = (hash ^ static_cast<std::uint32_t>(part)) * 0x9E3779B97F4A7C15ull;
  return static_cast<std::size_t>(hash ^ hash >> 32);
}

ParticleCells::ParticleCells(const Simulation& simulation, int field, double edge)
    : dimension_(simulation.experiment().dimension) {
  const Experiment& experiment = simulation.experiment();
  const auto D = static_cast<std::size_t>(dimension_);
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    if (experiment.bodies[body].field != field) continue;
    const BodyState state = simulation.backend().body_state(body);
    for (std::size_t p = 0; p + D <= state.position.size(); p += D) {
      Particle particle{{}, 0.5 * std::pow(state.volume, 1.0 / dimension_)};
      Key key{};
      for (std::size_t c = 0; c < D; ++c) {
        particle.position[c] = state.position[p + c];
        key[c] = static_cast<std::int32_t>(std::floor((state.position[p + c] - experiment.grid.lower[c]) / edge));
      }
      cells_[key].push_back(particle);
    }
  }
}

void ParticleCells::for_each_cell(
    const ParticleCells& others,
    const std::function<void(const Particles&, const std::vector<const Particles*>&)>& visit) const {
  std::vector<const Particles*> around;
  const int depth = dimension_ == 3 ? 1 : 0;
  for (const auto& [key, particles] : cells_) {
    around.clear();
    for (int k = -depth; k <= depth; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          const auto found = others.cells_.find({key[0] + i, key[1] + j, key[2] + k});
          if (found != others.cells_.end()) around.push_back(&found->second);
        }
    visit(particles, around);
  }
}

namespace {

/// The largest distance of two particles along an axis.
double apart(const ParticleCells::Particle& a, const ParticleCells::Particle& b) {
  double largest = 0;
  for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a.position[c] - b.position[c]));
  return largest;
}

}  // namespace

std::size_t lone_particles(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  const double reach = reach_of(experiment.shape.plugin->shape()) * experiment.grid.cell_size * (1 + 1e-9);
  std::size_t alone = 0;
  for (int field = 0; field < experiment.field_count; ++field) {
    const ParticleCells cells(simulation, field, reach);
    cells.for_each_cell(cells, [&](const auto& particles, const auto& around) {
      for (const ParticleCells::Particle& one : particles)
        alone += std::none_of(around.begin(), around.end(), [&](const auto* others) {
          return std::any_of(others->begin(), others->end(),
                             [&](const auto& other) { return &other != &one && apart(one, other) <= reach; });
        });
    });
  }
  return alone;
}

double gap_between_fields(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  if (experiment.field_count < 2) return std::numeric_limits<double>::quiet_NaN();
  const double edge = 2 * experiment.grid.cell_size;
  std::vector<ParticleCells> fields;
  for (int field = 0; field < experiment.field_count; ++field) fields.emplace_back(simulation, field, edge);
  double gap = edge;
  for (std::size_t a = 0; a < fields.size(); ++a)
    for (std::size_t b = a + 1; b < fields.size(); ++b)
      fields[a].for_each_cell(fields[b], [&](const auto& particles, const auto& around) {
        for (const ParticleCells::Particle& one : particles)
          for (const auto* others : around)
            for (const ParticleCells::Particle& other : *others)
              gap = std::min(gap, apart(one, other) - one.half_size - other.half_size);
      });
  return gap;
}

}  // namespace mpm::app
