#include "simulation/seeding.hpp"

#include <cmath>
#include <random>

#include "experiment/diagnostics.hpp"

namespace mpm {
namespace {

/// First and last lattice index that may lie inside [lower, upper] on one axis.
std::pair<long, long> lattice_range(const Experiment& experiment, int axis, double lower, double upper, int rows) {
  const GridSpecification& grid = experiment.grid;
  if (axis >= experiment.dimension) return {0, 0};
  const long last = static_cast<long>(grid.cells[axis]) * rows - 1;
  const double spacing = grid.cell_size / rows;
  const auto index = [&](double x) {
    return std::isfinite(x) ? static_cast<long>(std::floor((x - grid.lower[axis]) / spacing)) : (x < 0 ? 0 : last);
  };
  return {std::max(0L, index(lower) - 1), std::min(last, index(upper) + 1)};
}

/// Gradient of the initial velocity at x by central differences: exact for affine fields to rounding.
void append_velocity_gradient(const Experiment& experiment, const BodySpecification& body, const Vector3& x,
                              std::vector<double>& gradient) {
  const int D = experiment.dimension;
  const double step = 1e-4 * experiment.grid.cell_size;
  const std::size_t first = gradient.size();
  gradient.resize(first + D * D, 0.0);
  if (body.velocity.is_constant()) return;
  for (int axis = 0; axis < D; ++axis) {
    Vector3 ahead = x, behind = x;
    ahead[axis] += step;
    behind[axis] -= step;
    const Vector3 v = body.velocity(ahead, ahead, 0), w = body.velocity(behind, behind, 0);
    for (int c = 0; c < D; ++c) gradient[first + c * D + axis] = (v[c] - w[c]) / (ahead[axis] - behind[axis]);
  }
}

}  // namespace

SeededBody seed_body(const Experiment& experiment, int index) {
  const BodySpecification& body = experiment.bodies[index];
  const int D = experiment.dimension, rows = body.particles_per_cell_axis;
  const double spacing = experiment.grid.cell_size / rows;
  const auto [lower, upper] = body.geometry->bounds();
  std::array<std::pair<long, long>, 3> range;
  for (int axis = 0; axis < 3; ++axis) range[axis] = lattice_range(experiment, axis, lower[axis], upper[axis], rows);

  const bool affine = experiment.transfer.plugin->transfer().traits & MPM_AFFINE_CARRIES_ENERGY;
  std::mt19937_64 random(experiment.seed * 1000003ull + static_cast<unsigned>(index));
  SeededBody seeded;
  seeded.dimension = static_cast<std::size_t>(D);
  for (long k = range[2].first; k <= range[2].second; ++k)
    for (long j = range[1].first; j <= range[1].second; ++j)
      for (long i = range[0].first; i <= range[0].second; ++i) {
        const long at[3] = {i, j, k};
        Vector3 x{};
        for (int c = 0; c < D; ++c) x[c] = experiment.grid.lower[c] + (at[c] + 0.5) * spacing;
        if (!body.geometry->contains(x)) continue;
        if (body.jitter > 0)  // 53 bits of the generator: the same numbers with every standard library
          for (int c = 0; c < D; ++c)
            x[c] += body.jitter * spacing * (2.0 * static_cast<double>(random() >> 11) / 9007199254740992.0 - 1.0);
        const Vector3 v = body.velocity(x, x, 0);
        seeded.position.insert(seeded.position.end(), x.begin(), x.begin() + D);
        seeded.velocity.insert(seeded.velocity.end(), v.begin(), v.begin() + D);
        if (affine) append_velocity_gradient(experiment, body, x, seeded.velocity_gradient);
      }
  if (seeded.position.empty()) {
    Problem problem{experiment.file.string(), 0, 0, body.pointer + "/geometry",
                    "holds no particle: it is thinner than the particle spacing or outside the domain; use smaller "
                    "cells or more particles a cell"};
    for (const auto& [pointer, position] : experiment.positions)
      if (pointer == problem.pointer) problem.line = position.first, problem.column = position.second;
    throw InputError({problem});
  }
  seeded.volume = std::pow(spacing, D);
  seeded.mass = seeded.volume * experiment.materials[body.material].component.parameter("density");
  return seeded;
}

}  // namespace mpm
