#include "simulation/seeding.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "experiment/diagnostics.hpp"

namespace mpm {
namespace {

/// Returns the first and last lattice index that may lie inside [lower, upper] on one axis.
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

/// Lattice points side by side along x that lie in a body.
struct Run {
  std::array<long, 3> first{};
  long count = 0;
};

std::vector<Run> runs_inside(const Experiment& experiment, const BodySpecification& body) {
  const int D = experiment.dimension, rows = body.particles_per_cell_axis;
  const double spacing = experiment.grid.cell_size / rows;
  const auto [lower, upper] = body.geometry->bounds();
  std::array<std::pair<long, long>, 3> range;
  for (int axis = 0; axis < 3; ++axis) range[axis] = lattice_range(experiment, axis, lower[axis], upper[axis], rows);
  std::vector<Run> runs;
  for (long k = range[2].first; k <= range[2].second; ++k)
    for (long j = range[1].first; j <= range[1].second; ++j) {
      bool inside = false;
      for (long i = range[0].first; i <= range[0].second; ++i) {
        const long at[3] = {i, j, k};
        Vector3 x{};
        for (int c = 0; c < D; ++c) x[c] = experiment.grid.lower[c] + (at[c] + 0.5) * spacing;
        const bool before = inside;
        inside = body.geometry->contains(x);
        if (inside && !before) runs.push_back({{i, j, k}, 0});
        if (inside) ++runs.back().count;
      }
    }
  return runs;
}

/// Makes the particles of a body, a batch at a time.
class Seeder {
 public:
  Seeder(const Experiment& experiment, int index, bool affine)
      : experiment_(experiment),
        body_(experiment.bodies[index]),
        affine_(affine),
        random_(experiment.seed * 1000003ull + static_cast<unsigned>(index)) {}

  void make(const std::vector<Run>& runs, const std::function<void(const SeedBatch&)>& visit) {
    for (const Run& run : runs)
      for (long i = 0; i < run.count; ++i) {
        points_.push_back(point(run, i));
        if (points_.size() == batch_size) give(visit);
      }
    if (!points_.empty()) give(visit);
  }

 private:
  static constexpr std::size_t batch_size = 1024;

  Vector3 point(const Run& run, long i) {
    const double spacing = experiment_.grid.cell_size / body_.particles_per_cell_axis;
    const long at[3] = {run.first[0] + i, run.first[1], run.first[2]};
    Vector3 x{};
    for (int c = 0; c < experiment_.dimension; ++c) x[c] = experiment_.grid.lower[c] + (at[c] + 0.5) * spacing;
    if (body_.jitter > 0)  // 53 bits of the generator give the same numbers with every standard library
      for (int c = 0; c < experiment_.dimension; ++c)
        x[c] += body_.jitter * spacing * (2.0 * static_cast<double>(random_() >> 11) / 9007199254740992.0 - 1.0);
    return x;
  }

  void give(const std::function<void(const SeedBatch&)>& visit) {
    const std::size_t n = points_.size(), D = static_cast<std::size_t>(experiment_.dimension);
    position_.resize(n * D), velocity_.resize(n * D), values_.resize(n), velocities_.resize(n);
    body_.velocity.evaluate(points_, points_, 0, velocities_);
    for (std::size_t p = 0; p < n; ++p) {
      std::copy_n(points_[p].begin(), D, &position_[p * D]);
      std::copy_n(velocities_[p].begin(), D, &velocity_[p * D]);
    }
    if (affine_) differentiate();
    if (affine_ && (experiment_.transfer.plugin->transfer().traits & MPM_KEEPS_SPIN_ONLY)) keep_spin();
    seed_temperature();
    visit({given_, n, position_.data(), velocity_.data(), affine_ ? gradient_.data() : nullptr, others_});
    given_ += n;
    points_.clear();
  }

  /// Seeds the temperature; a particle warmer than the melting temperature starts melted.
  void seed_temperature() {
    if (!body_.temperature) return;
    std::vector<double>& temperature = fields_["temperature"];
    temperature.resize(points_.size());
    body_.temperature->evaluate(points_, 0, temperature.data());
    others_ = {{"temperature", temperature.data()}};
    const auto& thermal = experiment_.materials[body_.material].thermal;
    if (!thermal || !thermal->phase_change) return;
    std::vector<double>& melted = fields_["melted_fraction"];
    melted.clear();
    for (const double T : temperature) melted.push_back(T > thermal->phase_change->temperature ? 1 : 0);
    others_.emplace_back("melted_fraction", melted.data());
  }

  /// Takes the velocity's gradient by central differences, which are exact for affine fields to rounding.
  void differentiate() {
    const std::size_t n = points_.size(), D = static_cast<std::size_t>(experiment_.dimension);
    const double step = 1e-4 * experiment_.grid.cell_size;
    gradient_.assign(n * D * D, 0.0);
    behind_values_.resize(n);
    for (std::size_t axis = 0; axis < D; ++axis) {
      bool displaced = false;
      for (std::size_t c = 0; c < D; ++c) {
        if (!body_.velocity.varies(static_cast<int>(c), static_cast<int>(axis))) continue;
        if (!displaced) {
          ahead_ = behind_ = points_;
          for (std::size_t p = 0; p < n; ++p) ahead_[p][axis] += step, behind_[p][axis] -= step;
          displaced = true;
        }
        body_.velocity.evaluate(static_cast<int>(c), ahead_, 0, values_.data());
        body_.velocity.evaluate(static_cast<int>(c), behind_, 0, behind_values_.data());
        for (std::size_t p = 0; p < n; ++p)
          gradient_[(p * D + c) * D + axis] = (values_[p] - behind_values_[p]) / (ahead_[p][axis] - behind_[p][axis]);
      }
    }
  }

  /// Keeps only the antisymmetric part of the gradients.
  void keep_spin() {
    const std::size_t D = static_cast<std::size_t>(experiment_.dimension);
    for (std::size_t first = 0; first < gradient_.size(); first += D * D)
      for (std::size_t i = 0; i < D; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
          double &below = gradient_[first + i * D + j], &above = gradient_[first + j * D + i];
          below = 0.5 * (below - above), above = -below;
        }
  }

  const Experiment& experiment_;
  const BodySpecification& body_;
  bool affine_;
  std::mt19937_64 random_;
  std::size_t given_ = 0;
  std::vector<Vector3> points_, velocities_, ahead_, behind_;
  std::vector<double> position_, velocity_, gradient_, values_, behind_values_;
  std::map<std::string, std::vector<double>> fields_;
  std::vector<std::pair<std::string, const double*>> others_;
};

}  // namespace

SeededBody seed_body(const Experiment& experiment, int index) {
  const BodySpecification& body = experiment.bodies[index];
  SeededBody seeded;
  seeded.dimension = static_cast<std::size_t>(experiment.dimension);
  seeded.with_gradient =
      experiment.transfer.plugin->transfer().traits & (MPM_AFFINE_CARRIES_ENERGY | MPM_STARTS_WITH_GRADIENT);
  const auto runs = std::make_shared<const std::vector<Run>>(runs_inside(experiment, body));
  for (const Run& run : *runs) seeded.particles += static_cast<std::size_t>(run.count);
  seeded.make = [&experiment, index, runs, affine = seeded.with_gradient](const auto& visit) {
    Seeder(experiment, index, affine).make(*runs, visit);
  };
  if (seeded.particles == 0) {
    Problem problem{experiment.file.string(), 0, 0, body.pointer + "/geometry",
                    "holds no particle: it is thinner than the particle spacing or outside the domain; use smaller "
                    "cells or more particles a cell"};
    for (const auto& [pointer, position] : experiment.positions)
      if (pointer == problem.pointer) problem.line = position.first, problem.column = position.second;
    throw InputError({problem});
  }
  seeded.volume = std::pow(experiment.grid.cell_size / body.particles_per_cell_axis, experiment.dimension);
  seeded.mass = seeded.volume * experiment.materials[body.material].component.parameter("density");
  return seeded;
}

}  // namespace mpm
