#include "simulation/loads.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <type_traits>

#include "simulation/point_bins.hpp"

namespace mpm {
namespace {

constexpr double pi = std::numbers::pi;

/// Particles near the pieces of a surface, in bins of the side of two particle spacings.
class Neighbourhood {
 public:
  Neighbourhood(int dimension, double spacing, const Surface& pieces, const SeededBody& seeds)
      : dimension_(dimension), spacing_(spacing), seeds_(seeds), bins_(dimension, 2 * spacing) {
    for (const SurfacePiece& piece : pieces) bins_.open_around(piece.point);
    for_each_particle([&](const Particle& particle) { bins_.add_where_open(particle.x, particle); });
  }

  struct Particle {
    std::size_t id;
    Vector3 x;
  };
  /// The particles that are nearest to a point: several where they are equally far.
  std::vector<Particle> nearest(const Vector3& point) const {
    std::vector<Particle> found;
    double least = 1e300;
    const auto look = [&](const Particle& particle) { compare(particle, point, found, least); };
    bins_.for_each_near(point, look);
    if (found.empty()) {  // a corner that no particle is near
      if (all_.empty()) for_each_particle([&](const Particle& particle) { all_.push_back(particle); });
      for (const Particle& particle : all_) look(particle);
    }
    return found;
  }

 private:
  template <class Visit>
  void for_each_particle(Visit&& visit) const {
    const std::size_t D = static_cast<std::size_t>(dimension_);
    seeds_.for_each_batch([&](const SeedBatch& batch) {
      for (std::size_t p = 0; p < batch.count; ++p) {
        Particle particle{batch.first + p, {}};
        std::copy_n(batch.undeformed() + p * D, D, particle.x.begin());
        visit(particle);
      }
    });
  }
  void compare(const Particle& particle, const Vector3& point, std::vector<Particle>& found, double& least) const {
    const double same = 1e-6 * spacing_ * spacing_;
    double squared = 0;
    for (int c = 0; c < dimension_; ++c) squared += (point[c] - particle.x[c]) * (point[c] - particle.x[c]);
    if (squared < least - same) found.clear();
    if (squared < least + same) found.push_back(particle);
    least = std::min(least, squared);
  }

  int dimension_;
  double spacing_;
  const SeededBody& seeds_;
  PointBins<Particle> bins_;
  mutable std::vector<Particle> all_;  ///< filled where a point is far from every particle: seeding again is slow
};

}  // namespace

BodyLoads::BodyLoads(const Experiment& experiment, int body, const SeededBody& seeds)
    : experiment_(experiment),
      body_(body),
      dimension_(experiment.dimension),
      spacing_(experiment.grid.cell_size / experiment.bodies[body].particles_per_cell_axis) {
  for (const ExternalForce force : external_forces)
    gives_[static_cast<std::size_t>(force)] = !experiment.giver_of(force, body).empty();
  if (experiment.body_force) accelerations_.push_back({&*experiment.body_force, nullptr});
  for (const Load& load : experiment.loads)
    if (load.body == body && load.gives(ExternalForce::body_force)) accelerations_.push_back({&load.value, &load});
  if (!experiment.loaded_at_points(body).empty()) take_shares(seeds);
}

bool BodyLoads::all_held(const Vector3& values) const {
  return std::all_of(values.begin(), values.end(),
                     [&](double value) { return represents(experiment_.precision, value); });
}

bool BodyLoads::any() const {
  return std::any_of(gives_.begin(), gives_.end(), [](bool gives) { return gives; });
}

/// The pieces of a surface, line or point that a load acts on. A surface has eight to a particle's spacing, in 3-D four,
/// so that the rim of a region is known to that.
Surface BodyLoads::pieces_of(const Load& load) const {
  Surface pieces;
  switch (load.type) {
    case LoadType::force:
      return {{load.from, {}, 1}};
    case LoadType::line_force:
      add_edge(pieces, load.from, load.to, {}, spacing_ / 8);
      return pieces;
    default:
      return loaded_surface(load, *experiment_.bodies[body_].geometry, {experiment_.grid.lower, experiment_.grid.upper},
                            spacing_ / (dimension_ == 2 ? 8 : 4));
  }
}

void BodyLoads::take_shares(const SeededBody& seeds) {
  const int D = dimension_;
  std::map<std::pair<std::size_t, int>, Share> shares;  // by particle, then by load
  for (int number = 0; number < static_cast<int>(experiment_.loads.size()); ++number) {
    const Load& load = experiment_.loads[number];
    if (load.body != body_ || !load.at_points()) continue;
    const Surface pieces = pieces_of(load);
    const Neighbourhood neighbourhood(D, spacing_, pieces, seeds);
    for (const SurfacePiece& piece : pieces) {
      const bool rings = experiment_.axisymmetric() && load.on_surface();
      if (rings && piece.point[0] < 1e-9 * spacing_) continue;  // the axis is no surface
      const auto nearest = neighbourhood.nearest(piece.point);
      for (const Neighbourhood::Particle& particle : nearest) {
        const double section = piece.area / static_cast<double>(nearest.size());
        const double area = rings ? 2 * pi * piece.point[0] * section : section;
        Share& share = shares[{particle.id, number}];
        share.load = number;
        share.measure += area;
        Vector3 r{};
        for (int c = 0; c < D; ++c) r[c] = piece.point[c] - particle.x[c], share.first[c] += area * r[c];
        const double of_normals = load.follower ? section : area;
        for (int i = 0; i < D; ++i) {
          share.area[i] += of_normals * piece.normal[i];
          for (int j = 0; j < D; ++j) share.area_moment[D * i + j] += of_normals * piece.normal[i] * r[j];
        }
      }
    }
  }
  first_.assign(seeds.count() + 1, 0);
  for (const auto& [of, share] : shares) ++first_[of.first + 1], shares_.push_back(share);
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

bool BodyLoads::accelerations_use_position() const {
  return std::any_of(accelerations_.begin(), accelerations_.end(),
                     [](const PerMass& force) { return force.expression->uses_position(); });
}

bool BodyLoads::accelerations_use_initial_position() const {
  return std::any_of(accelerations_.begin(), accelerations_.end(),
                     [](const PerMass& force) { return force.expression->uses_initial_position(); });
}

Vector3 BodyLoads::acceleration(std::size_t id, const Vector3& x, const Vector3& X, double time,
                                FirstFailure& failures) const {
  Vector3 sum{};
  for (const PerMass& force : accelerations_) {
    const Vector3 value = (*force.expression)(x, X, time);
    if (!all_held(value)) failures.note(force_failure(experiment_, force.load, body_, id, x, X, time));
    for (int c = 0; c < dimension_; ++c) sum[c] += value[c];
  }
  return sum;
}

template <class T>
void BodyLoads::accelerations(std::size_t count, const std::int32_t* ids, const PointArrays<T>& at, double time,
                              const std::array<T*, 3>& result, FirstFailure& failures) const {
  bool good = accelerations_.front().expression->evaluate(count, at, time, result) == count;
  constexpr std::size_t piece = 64;
  T values[3][piece];
  const std::array<T*, 3> more{values[0], values[1], values[2]};
  const auto from = [](const T* array, std::size_t first) { return array ? array + first : nullptr; };
  for (std::size_t k = 1; k < accelerations_.size(); ++k)
    for (std::size_t first = 0; first < count; first += piece) {
      PointArrays<T> here;
      for (int c = 0; c < dimension_; ++c) here.x[c] = from(at.x[c], first), here.X[c] = from(at.X[c], first);
      const std::size_t n = std::min(piece, count - first);
      good = accelerations_[k].expression->evaluate(n, here, time, more) == n && good;
      for (int c = 0; c < dimension_; ++c)
        for (std::size_t p = 0; p < n; ++p) result[c][first + p] += values[c][p];
    }
  for (std::size_t p = 0; !good && p < count; ++p) {
    Vector3 x{}, X{}, sum{};
    for (int c = 0; c < dimension_; ++c) {
      sum[c] = result[c][p];
      if (at.x[c]) x[c] = at.x[c][p];
      if (at.X[c]) X[c] = at.X[c][p];
    }
    if (!all_held(sum)) note_acceleration(static_cast<std::size_t>(ids[p]), x, X, time, failures);
  }
}

template void BodyLoads::accelerations(std::size_t, const std::int32_t*, const PointArrays<double>&, double,
                                       const std::array<double*, 3>&, FirstFailure&) const;
template void BodyLoads::accelerations(std::size_t, const std::int32_t*, const PointArrays<float>&, double,
                                       const std::array<float*, 3>&, FirstFailure&) const;

void BodyLoads::note_acceleration(std::size_t id, const Vector3& x, const Vector3& X, double time,
                                  FirstFailure& failures) const {
  bool noted = false;
  for (const PerMass& force : accelerations_) {
    if (gives_numbers(experiment_, *force.expression, x, X, time)) continue;
    failures.note(force_failure(experiment_, force.load, body_, id, x, X, time));
    noted = true;
  }
  // The sum alone may be beyond the range.
  if (!noted) failures.note(force_failure(experiment_, accelerations_.front().load, body_, id, x, X, time));
}

bool BodyLoads::carries(ExternalForce force, std::size_t id) const {
  if (first_.empty()) return false;
  for (std::uint32_t k = first_[id]; k < first_[id + 1]; ++k)
    if (experiment_.loads[shares_[k].load].gives(force)) return true;
  return false;
}

template <int D>
LoadCoefficients BodyLoads::coefficients(ExternalForce force, std::size_t id, const LoadedParticle& particle,
                                         double time, FirstFailure& failures) const {
  const auto vector = [](const Vector3& values) {
    Vec<D, double> v;
    std::copy_n(values.begin(), D, v.v);
    return v;
  };
  const Vec<D, double> x = vector(particle.x), X = vector(particle.X), v = vector(particle.v);
  Mat<D, double> F;
  std::copy_n(particle.F.begin(), D * D, F.m);
  GivenByLoads<D, double> sum;
  for (std::uint32_t k = first_[id]; k < first_[id + 1]; ++k) {
    const Share& share = shares_[k];
    const Load& load = experiment_.loads[share.load];
    if (!load.gives(force)) continue;
    const SharePlace<D, double> place(share, x, X, F);
    Vec<D, double> value{};
    if (load.type != LoadType::spring) {
      Vector3 here{}, start = particle.X;
      std::copy_n(place.x.v, D, here.begin());
      std::copy_n(place.X.v, D, start.begin());
      const Vector3 given = load.value(here, start, time);
      if (!all_held(given)) failures.note(force_failure(experiment_, &load, body_, id, here, start, time));
      value = vector(given);
    }
    if (force == ExternalForce::spring) value = spring_force(load.stiffness.data(), share, place, x, X);
    if (force == ExternalForce::dashpot) value = dashpot_force(load.damping.data(), v);
    if (load.type == LoadType::pressure)
      add_pressure(share, place, x, F, value[0], load.follower, load.follower && experiment_.axisymmetric(), sum);
    else
      add_force(share, place, value, sum);
  }
  LoadCoefficients coefficients;
  std::copy_n(sum.b.v, D, coefficients.b.begin());
  std::copy_n(sum.S.m, D * D, coefficients.S.begin());
  return coefficients;
}

Failure BodyLoads::failed_formula(std::size_t id, const LoadedParticle& particle, double time) const {
  const auto middle = [&]<int D>(std::integral_constant<int, D>, const Share& share) {
    Vec<D, double> x, X;
    Mat<D, double> F;
    std::copy_n(particle.x.begin(), D, x.v), std::copy_n(particle.X.begin(), D, X.v);
    std::copy_n(particle.F.begin(), D * D, F.m);
    const SharePlace<D, double> place(share, x, X, F);
    std::pair<Vector3, Vector3> found{particle.x, particle.X};
    std::copy_n(place.x.v, D, found.first.begin()), std::copy_n(place.X.v, D, found.second.begin());
    return found;
  };
  std::optional<Failure> first;
  for (std::uint32_t k = first_[id]; k < first_[id + 1]; ++k) {
    const Load& load = experiment_.loads[shares_[k].load];
    if (load.type == LoadType::spring) continue;
    const auto [x, X] = dimension_ == 2 ? middle(std::integral_constant<int, 2>(), shares_[k])
                                        : middle(std::integral_constant<int, 3>(), shares_[k]);
    const bool good = gives_numbers(experiment_, load.value, x, X, time);
    if (good && first) continue;
    first = force_failure(experiment_, &load, body_, id, x, X, time);
    if (!good) break;
  }
  return first.value();
}

template LoadCoefficients BodyLoads::coefficients<2>(ExternalForce, std::size_t, const LoadedParticle&, double,
                                                     FirstFailure&) const;
template LoadCoefficients BodyLoads::coefficients<3>(ExternalForce, std::size_t, const LoadedParticle&, double,
                                                     FirstFailure&) const;

}  // namespace mpm
