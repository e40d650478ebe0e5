#include "plan/memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "experiment/diagnostics.hpp"
#include "plan/compatibility.hpp"

namespace mpm {
namespace {

/// Share of a body's bounding box that it fills, from a fixed low-discrepancy sample.
double filled_share(const Geometry& geometry, const Vector3& lower, const Vector3& upper) {
  constexpr int samples = 4096;
  int inside = 0;
  for (int k = 0; k < samples; ++k) {
    const double u[3] = {std::fmod(0.5 + k * 0.8191725133961645, 1.0), std::fmod(0.5 + k * 0.6710436067037893, 1.0),
                         std::fmod(0.5 + k * 0.5497004779019703, 1.0)};
    Vector3 x{};
    for (int c = 0; c < 3; ++c) x[c] = lower[c] + u[c] * (upper[c] - lower[c]);
    inside += geometry.contains(x);
  }
  return std::max(inside, 1) / static_cast<double>(samples);
}

/// The particles that fill a region as those of a body do.
double particles_in(const Geometry& region, const BodySpecification& body, const Experiment& experiment) {
  auto [lower, upper] = region.bounds();
  double count = 1;
  for (int c = 0; c < experiment.dimension; ++c) {
    lower[c] = std::max(lower[c], experiment.grid.lower[c]);
    upper[c] = std::min(upper[c], experiment.grid.upper[c]);
    count *= std::max(0.0, (upper[c] - lower[c]) / experiment.grid.cell_size * body.particles_per_cell_axis);
  }
  return count > 0 ? count * filled_share(region, lower, upper) : 0;
}

/// The most particles that a body has on the way, as far as it is known before: where others leave it, one batch of each
/// emitter is counted.
double estimated_particles(int number, const Experiment& experiment) {
  const BodySpecification& body = experiment.bodies[static_cast<std::size_t>(number)];
  double count = particles_in(*body.geometry, body, experiment);
  for (const Emitter& emitter : experiment.emitters) {
    if (emitter.body != number) continue;
    const long batches = experiment.loses_particles(number) ? 1 : emitter.batches_until(experiment.solver.end_time);
    count += static_cast<double>(batches) * particles_in(*emitter.geometry, body, experiment);
    if (count > 1.05 * static_cast<double>(emitter.max_particles))  // of an estimate
      refuse(experiment, emitter.pointer + "/max_particles",
             "body " + in_quotes(body.name) + " would have about " + number_text(std::round(count)) +
                 " particles, and may have " + number_text(static_cast<double>(emitter.max_particles)) +
                 "; raise max_particles, end the emitter with \"until\", or take larger cells");
  }
  return count;
}

}  // namespace

double available_bytes() {
  double available = 8e9;
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);)
    if (unsigned long long kilobytes = 0; std::sscanf(line.c_str(), "MemAvailable: %llu kB", &kilobytes) == 1)
      available = static_cast<double>(kilobytes) * 1024.0;
  double limit = 0, used = 0;
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> limit && std::ifstream("/sys/fs/cgroup/memory.current") >> used)
    available = std::min(available, limit - used);
  return available;
}

namespace {

void refuse_too_large(const Experiment& experiment, double particles, double particle_bytes, double grid_bytes) {
  const double needed = particle_bytes + grid_bytes, available = available_bytes();
  if (particles < 2e9 && needed < 0.9 * available) return;
  std::ostringstream message;
  message.precision(3);
  message << "the scene needs about " << needed / 1e9 << " GB (" << particles << " particles, " << particle_bytes / 1e9
          << " GB of state, " << grid_bytes / 1e9 << " GB of grid), and " << available / 1e9
          << " GB are free; use larger cells, fewer particles a cell or smaller bodies";
  refuse(experiment, "/grid/cell_size", message.str());
}

}  // namespace

void estimate_memory(Plan& plan, const Experiment& experiment) {
  const int D = experiment.dimension;
  const mpm_shape& shape = experiment.shape.plugin->shape();
  const double padding = shape.form == MPM_NODE_LIST ? 8 : 3;  // nodes beyond a wall: grid_padding_of(shape)
  double particles = 0, particle_bytes = 0, occupied_cells = 0, domain_nodes = 1;
  for (std::size_t b = 0; b < experiment.bodies.size(); ++b) {
    const double count = estimated_particles(static_cast<int>(b), experiment);
    particles += count;
    particle_bytes += count * static_cast<double>(plan.bytes_per_particle(static_cast<int>(b)));
    occupied_cells += count / std::pow(experiment.bodies[b].particles_per_cell_axis, D);
  }
  for (int c = 0; c < D; ++c) domain_nodes *= experiment.grid.cells[c] + 1 + 2 * padding;
  // The cpu backend keeps blocks around particles only: a body's cells and a rim of about one block on every side.
  const double rim = 12 * D * std::pow(occupied_cells, (D - 1.0) / D) * (D == 2 ? 8 : 4) / 4 + 4096;
  const double nodes =
      experiment.backend == "cpu" ? std::min(domain_nodes * 2, 1.3 * occupied_cells + rim) : domain_nodes;
  if (experiment.backend == "cpu")
    particle_bytes += particle_bytes * 3 / 10;  // of batches that are not full, and of those that a sort is moving
  // The reference backend keeps stencils and all moments of a particle, and every value of a node side by side.
  const bool list = shape.form == MPM_NODE_LIST;
  const double stencil = (list ? shape.capacity[D - 2] * (100.0 + 12 * D) : std::pow(shape.width, D) * 88.0) + 700;
  if (experiment.backend == "reference") particle_bytes += particles * stencil;
  const double grid_bytes = nodes * (experiment.backend == "reference" ? 290.0 * experiment.field_count
                                                                       : static_cast<double>(plan.bytes_per_node()));
  refuse_too_large(experiment, particles, particle_bytes, grid_bytes);
  plan.particles = static_cast<std::uint64_t>(particles);
  plan.nodes = static_cast<std::uint64_t>(nodes);
  plan.particle_bytes = static_cast<std::uint64_t>(particle_bytes);
  plan.grid_bytes = static_cast<std::uint64_t>(grid_bytes);
}

}  // namespace mpm
