#include "simulation/seeding.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <span>

#include "experiment/diagnostics.hpp"
#include "experiment/places.hpp"
#include "simulation/formula_problem.hpp"
#include "simulation/grips.hpp"
#include "simulation/imposed_value.hpp"
#include "simulation/initial_state.hpp"

namespace mpm {
namespace {

[[noreturn]] void refuse(const Experiment& experiment, const std::string& pointer, const std::string& message) {
  throw InputError({problem_at(experiment, pointer, message)});
}

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
        index_(index),
        body_(experiment.bodies[index]),
        affine_(affine),
        random_(experiment.seed * 1000003ull + static_cast<unsigned>(index)),
        state_(experiment, index) {}

  void make(const std::vector<Run>& runs, const std::function<void(const SeedBatch&)>& visit) {
    const double spacing = experiment_.grid.cell_size / body_.particles_per_cell_axis;
    for (const Run& run : runs)
      for (long i = 0; i < run.count; ++i) {
        const long at[3] = {run.first[0] + i, run.first[1], run.first[2]};
        Vector3 x{};
        for (int c = 0; c < experiment_.dimension; ++c) x[c] = experiment_.grid.lower[c] + (at[c] + 0.5) * spacing;
        add(x, {spacing, spacing, spacing}, visit);
      }
    if (!points_.empty()) give(visit);
  }

  void make(const Places& places, const std::function<void(const SeedBatch&)>& visit) {
    places_ = &places;
    for (const Vector3& x : places.points) add(x, places.spacing, visit);
    if (!points_.empty()) give(visit);
  }

 private:
  static constexpr std::size_t batch_size = 1024;

  void add(Vector3 x, const Vector3& spacing, const std::function<void(const SeedBatch&)>& visit) {
    if (body_.jitter > 0)  // 53 bits of the generator give the same numbers with every standard library
      for (int c = 0; c < experiment_.dimension; ++c)
        x[c] += body_.jitter * spacing[c] * (2.0 * static_cast<double>(random_() >> 11) / 9007199254740992.0 - 1.0);
    points_.push_back(x);
    if (points_.size() == batch_size) give(visit);
  }

  void give(const std::function<void(const SeedBatch&)>& visit) {
    const std::size_t n = points_.size(), D = static_cast<std::size_t>(experiment_.dimension);
    others_.clear();
    moved_ = points_;
    if (body_.displacement) displace();
    seed_temperature();
    if (body_.deformed()) deform();
    position_.resize(n * D), velocity_.resize(n * D), values_.resize(n);
    for (std::size_t p = 0; p < n; ++p) std::copy_n(moved_[p].begin(), D, &position_[p * D]);
    seed_velocity();
    if (affine_ && (experiment_.transfer.plugin->transfer().traits & MPM_KEEPS_SPIN_ONLY)) keep_spin();
    if (body_.varies_in_size() || (experiment_.axisymmetric() && body_.deformed())) seed_size();
    if (body_.seeds_domains()) seed_domains();
    if (!experiment_.grips.empty()) seed_grips();
    visit({given_, n, position_.data(), velocity_.data(), affine_ ? gradient_.data() : nullptr, others_});
    given_ += n;
    points_.clear();
  }

  /// Room for a field of this batch, which the seeds then name.
  std::vector<double>& field(const std::string& key, std::size_t components) {
    std::vector<double>& values = fields_[key];
    values.assign(points_.size() * components, 0.0);
    others_.emplace_back(key, values.data());
    return values;
  }

  void displace() {
    const std::size_t D = static_cast<std::size_t>(experiment_.dimension);
    std::vector<Vector3> u(points_.size());
    const std::size_t finite = body_.displacement->evaluate(points_, points_, 0, u);
    if (finite < points_.size())
      refuse_not_finite(experiment_, body_, {"/initial_displacement", true}, *body_.displacement, points_[finite]);
    std::vector<double>& undeformed = field("initial_position", D);
    for (std::size_t p = 0; p < points_.size(); ++p)
      for (std::size_t c = 0; c < D; ++c) undeformed[p * D + c] = points_[p][c], moved_[p][c] += u[p][c];
    check_domain();
  }

  void check_domain() const {
    const GridSpecification& grid = experiment_.grid;
    for (std::size_t p = 0; p < points_.size(); ++p)
      for (int c = 0; c < experiment_.dimension; ++c)
        if (!(moved_[p][c] >= grid.lower[c] && moved_[p][c] <= grid.upper[c]))
          refuse_body(experiment_, body_, "/initial_displacement",
                      "moves a particle out of the domain, from " + point_text(experiment_, points_[p]));
  }

  /// Seeds the temperature; a particle warmer than the melting temperature starts melted.
  void seed_temperature() {
    if (!body_.temperature) return;
    std::vector<double>& temperature = field("temperature", 1);
    body_.temperature->evaluate(moved_, points_, 0, temperature.data());
    const auto& thermal = experiment_.materials[body_.material].thermal;
    if (!thermal || !thermal->phase_change) return;
    std::vector<double>& melted = field("melted_fraction", 1);
    for (std::size_t p = 0; p < points_.size(); ++p)
      melted[p] = temperature[p] > thermal->phase_change->temperature ? 1 : 0;
  }

  void deform() {
    const auto known = [&](const char* key) -> std::span<const double> {
      const auto found = fields_.find(key);
      return found == fields_.end() ? std::span<const double>() : found->second;
    };
    state_.find(points_, moved_, known("temperature"), known("melted_fraction"));
    for (const auto& [name, values] : state_.fields()) others_.emplace_back("material/" + name, values.data());
    const int D = experiment_.dimension;
    std::vector<double>& F = field("deformation", static_cast<std::size_t>(D) * D);
    for (std::size_t p = 0; p < points_.size(); ++p)
      for (int i = 0; i < D; ++i)
        for (int k = 0; k < D; ++k) F[(p * D + i) * D + k] = state_.deformation_gradient(p)[3 * i + k];
  }

  void seed_size() {
    const double ring = 2 * std::numbers::pi;
    std::vector<double>& size = field("size", 1);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      size[p] = places_ && !places_->shares.empty() ? places_->shares[given_ + p] : 1;
      if (experiment_.axisymmetric()) size[p] *= ring * points_[p][0];
    }
  }

  /// Seeds each particle's box, deformed as the particle is, in cells.
  void seed_domains() {
    const std::size_t D = static_cast<std::size_t>(experiment_.dimension), corners = std::size_t(1) << D;
    const double h = experiment_.grid.cell_size, half = 0.5 / body_.particles_per_cell_axis;
    std::vector<double>&domain = field("domain", D * D), &corner = field("corners", D * corners);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      double* const box = &domain[p * D * D];
      for (std::size_t i = 0; i < D; ++i)
        for (std::size_t k = 0; k < D; ++k)
          for (std::size_t m = 0; m < D; ++m)
            box[i * D + k] += stretch(p, i, m) * (places_ ? side(p, m, k) / h : m == k ? half : 0);
      for (std::size_t c = 0; c < corners; ++c)
        for (std::size_t i = 0; i < D; ++i)
          for (std::size_t k = 0; k < D; ++k)
            corner[(p * corners + c) * D + i] += (c >> k & 1 ? 1 : -1) * box[i * D + k];
    }
  }
  double stretch(std::size_t p, std::size_t i, std::size_t k) const {
    return body_.deformed() ? state_.deformation_gradient(p)[3 * i + k] : i == k ? 1 : 0;
  }
  double side(std::size_t p, std::size_t i, std::size_t k) const {
    const std::size_t D = static_cast<std::size_t>(experiment_.dimension);
    const std::size_t first = places_->boxes.size() == D * D ? 0 : (given_ + p) * D * D;
    return places_->boxes[first + i * D + k];
  }

  void seed_velocity() {
    const std::size_t n = points_.size(), D = static_cast<std::size_t>(experiment_.dimension);
    velocities_.resize(n);
    body_.velocity.evaluate(moved_, points_, 0, velocities_);
    for (std::size_t p = 0; p < n; ++p) std::copy_n(velocities_[p].begin(), D, &velocity_[p * D]);
    if (affine_ && body_.displacement) differentiate_displaced();
    if (affine_ && !body_.displacement) differentiate();
  }

  /// Takes the gradient by the place after the displacement: where x goes a step, X goes F^-1 of it.
  void differentiate_displaced() {
    const std::size_t n = points_.size(), D = static_cast<std::size_t>(experiment_.dimension);
    const double step = 1e-4 * experiment_.grid.cell_size;
    gradient_.assign(n * D * D, 0.0);
    std::vector<Vector3> front(n), back(n);
    for (std::size_t axis = 0; axis < D; ++axis) {
      std::vector<Vector3> from = moved_, to = moved_, from_X = points_, to_X = points_;
      for (std::size_t p = 0; p < n; ++p) {
        to[p][axis] += step, from[p][axis] -= step;
        const Vector3 way = state_.undeformed(p, axis);
        for (std::size_t c = 0; c < D; ++c) to_X[p][c] += step * way[c], from_X[p][c] -= step * way[c];
      }
      body_.velocity.evaluate(to, to_X, 0, front);
      body_.velocity.evaluate(from, from_X, 0, back);
      for (std::size_t p = 0; p < n; ++p)
        for (std::size_t c = 0; c < D; ++c)
          gradient_[(p * D + c) * D + axis] = (front[p][c] - back[p][c]) / (to[p][axis] - from[p][axis]);
    }
  }

  /// Says which grip holds each particle, one after the number of the grip, and gives it the velocity of the start.
  void seed_grips() {
    std::vector<double>& holder = field("grip", 1);
    const std::size_t D = static_cast<std::size_t>(experiment_.dimension);
    for (std::size_t k = 0; k < experiment_.grips.size(); ++k) {
      const Grip& grip = experiment_.grips[k];
      if (grip.body != index_) continue;
      for (std::size_t p = 0; p < points_.size(); ++p) {
        const Vector3& x = points_[p];
        if (!grip.region->contains(x)) continue;
        if (holder[p] > 0)
          refuse(experiment_, grip.pointer + "/where",
                 "holds particles that grip " +
                     in_quotes(experiment_.grips[static_cast<std::size_t>(holder[p]) - 1].name) + " holds too");
        holder[p] = static_cast<double>(k + 1);
        const Vector3 velocity = velocity_of(experiment_, grip, moved_[p], x, 0);
        for (std::size_t c = 0; c < D; ++c)
          if (grip.held[c]) velocity_[p * D + c] = velocity[c];
      }
    }
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
  const int index_;
  const BodySpecification& body_;
  bool affine_;
  std::mt19937_64 random_;
  InitialState state_;
  const Places* places_ = nullptr;  ///< null on the lattice of the cells
  std::size_t given_ = 0;
  std::vector<Vector3> points_, moved_;  ///< undeformed, and where they begin
  std::vector<Vector3> velocities_, ahead_, behind_;
  std::vector<double> position_, velocity_, gradient_, values_, behind_values_;
  std::map<std::string, std::vector<double>> fields_;
  std::vector<std::pair<std::string, const double*>> others_;
};

/// Refuses grips of a body that hold no particle, or give one what nothing can have.
void refuse_impossible_grips(const Experiment& experiment, int body, const SeededBody& seeded) {
  for (std::size_t k = 0; k < experiment.grips.size(); ++k) {
    const Grip& grip = experiment.grips[k];
    if (grip.body != body) continue;
    bool holds = false;
    try {
      seeded.for_each_batch([&](const SeedBatch& batch) {
        for (const auto& [key, holder] : batch.others)
          holds = holds || (key == "grip" && std::find(holder, holder + batch.count, static_cast<double>(k + 1)) !=
                                                 holder + batch.count);
      });
    } catch (const ImposedValueFailure& failure) {
      throw InputError({problem_of(experiment, failure.imposed)});
    }
    if (!holds)
      refuse(experiment, grip.pointer + "/where",
             "holds no particle of body " + in_quotes(experiment.bodies[static_cast<std::size_t>(body)].name));
  }
}

}  // namespace

SeededBody seed_body(const Experiment& experiment, int index) {
  const BodySpecification& body = experiment.bodies[index];
  SeededBody seeded;
  seeded.dimension = static_cast<std::size_t>(experiment.dimension);
  seeded.with_gradient =
      experiment.transfer.plugin->transfer().traits & (MPM_AFFINE_CARRIES_ENERGY | MPM_STARTS_WITH_GRADIENT);
  seeded.with_size = body.varies_in_size() || (experiment.axisymmetric() && body.deformed());
  seeded.volume = nominal_volume(experiment.grid, experiment.dimension, body);
  if (body.seeding.kind == SeedingKind::lattice) {
    const auto runs = std::make_shared<const std::vector<Run>>(runs_inside(experiment, body));
    for (const Run& run : *runs) seeded.particles += static_cast<std::size_t>(run.count);
    seeded.make = [&experiment, index, runs, affine = seeded.with_gradient](const auto& visit) {
      Seeder(experiment, index, affine).make(*runs, visit);
    };
  } else {
    const PlacingScene scene{experiment.grid, experiment.dimension,
                             experiment.seed * 1000003ull + static_cast<unsigned>(index)};
    const auto places = std::make_shared<const Places>(place_particles(scene, body));
    seeded.particles = places->points.size();
    seeded.volume = places->volume;
    seeded.make = [&experiment, index, places, affine = seeded.with_gradient](const auto& visit) {
      Seeder(experiment, index, affine).make(*places, visit);
    };
  }
  if (seeded.particles == 0 && !body.starts_empty)
    refuse_body(experiment, body, "/geometry",
                "holds no particle: it is thinner than the particle spacing or outside the domain; use smaller "
                "cells or more particles a cell");
  refuse_impossible_grips(experiment, index, seeded);
  seeded.mass = seeded.volume * experiment.materials[body.material].component.parameter("density");
  return seeded;
}

}  // namespace mpm
