#include "run/overlaps.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <sstream>

#include "experiment/diagnostics.hpp"
#include "simulation/emitters.hpp"
#include "simulation/point_bins.hpp"
#include "simulation/seeding.hpp"

namespace mpm::app {
namespace {

using Points = std::vector<Vector3>;

struct Box {
  Vector3 lower{}, upper{};
};

template <class Visit>
void for_each_place(const Experiment& experiment, int body, Visit visit) {
  const std::size_t D = static_cast<std::size_t>(experiment.dimension);
  seed_body(experiment, body).for_each_batch([&](const SeedBatch& batch) {
    for (std::size_t p = 0; p < batch.count; ++p) {
      Vector3 x{};
      std::copy_n(batch.position + p * D, D, x.begin());
      visit(x);
    }
  });
}

Points places_of(const Experiment& experiment, int body) {
  Points points;
  for_each_place(experiment, body, [&](const Vector3& x) { points.push_back(x); });
  return points;
}

/// Where a body that begins as it is drawn lies, within the domain; the domain itself for others.
Box bounds_of(const Experiment& experiment, const BodySpecification& body) {
  Box box{experiment.grid.lower, experiment.grid.upper};
  if (body.deformed() || !body.geometry) return box;
  const auto [lower, upper] = body.geometry->bounds();
  for (int c = 0; c < experiment.dimension; ++c)
    box.lower[c] = std::max(box.lower[c], lower[c]), box.upper[c] = std::min(box.upper[c], upper[c]);
  return box;
}

/// What two boxes share; where that is no volume, the upper corner is not above the lower one.
Box common(const Box& a, const Box& b) {
  Box box;
  for (std::size_t c = 0; c < 3; ++c)
    box.lower[c] = std::max(a.lower[c], b.lower[c]), box.upper[c] = std::min(a.upper[c], b.upper[c]);
  return box;
}

bool has_volume(const Experiment& experiment, const Box& box) {
  for (int c = 0; c < experiment.dimension; ++c)
    if (!(box.upper[c] - box.lower[c] > 1e-6 * experiment.grid.cell_size)) return false;
  return true;
}

std::size_t count_within(const Points& points, const Box& box, int dimension) {
  return static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const Vector3& x) {
    bool inside = true;
    for (int c = 0; c < dimension; ++c) inside = inside && x[c] > box.lower[c] && x[c] < box.upper[c];
    return inside;
  }));
}

/// The particles of a body in bins of the side of their spacing.
class Bins {
 public:
  Bins(const Points& points, int dimension, double spacing)
      : dimension_(dimension), spacing_(spacing), bins_(dimension, spacing) {
    for (const Vector3& x : points) bins_.add(x, x);
  }
  /// How many of the points have a particle within a share of the spacing, along every axis.
  std::size_t count_near(const Points& points, double share) const {
    return static_cast<std::size_t>(
        std::count_if(points.begin(), points.end(), [&](const Vector3& x) { return any_near(x, share * spacing_); }));
  }

 private:
  bool any_near(const Vector3& point, double reach) const {
    bool any = false;
    bins_.for_each_near(point, [&](const Vector3& x) {
      bool near = true;
      for (int c = 0; c < dimension_; ++c) near = near && std::abs(x[c] - point[c]) < reach;
      any = any || near;
    });
    return any;
  }

  int dimension_;
  double spacing_;
  PointBins<Vector3> bins_;
};

/// Bodies with what was found out about them so far.
class Places {
 public:
  explicit Places(const Experiment& experiment) : experiment_(experiment) {}
  const Points& of(int body) {
    const auto found = points_.find(body);
    return found != points_.end() ? found->second : points_.emplace(body, places_of(experiment_, body)).first->second;
  }
  const Bins& bins_of(int body) {
    const auto found = bins_.find(body);
    if (found != bins_.end()) return found->second;
    const double spacing = experiment_.grid.cell_size / experiment_.bodies[body].particles_per_cell_axis;
    return bins_.try_emplace(body, of(body), experiment_.dimension, spacing).first->second;
  }

 private:
  const Experiment& experiment_;
  std::map<int, Points> points_;
  std::map<int, Bins> bins_;
};

/// Counts the particles of overlap.body inside overlap.rigid_body, and adds it where there are any.
void note_overlap(const Experiment& experiment, RigidOverlap overlap, std::vector<RigidOverlap>& found) {
  const Geometry& geometry = *experiment.rigid_bodies[static_cast<std::size_t>(overlap.rigid_body)].geometry;
  for_each_place(experiment, overlap.body, [&](const Vector3& x) {
    const double depth = -geometry.distance(x);
    if (!(depth > 1e-6 * experiment.grid.cell_size)) return;  // else it touches
    ++overlap.particles;
    overlap.deepest = std::max(overlap.deepest, depth);
  });
  if (overlap.particles > 0) found.push_back(overlap);
}

constexpr double half = 0.5 * (1 - 1e-6);  ///< particles of bodies that touch are half a spacing from the face each
constexpr double same_place = 1e-6;

}  // namespace

std::vector<Overlap> overlaps_of(const Experiment& experiment) {
  std::vector<Overlap> found;
  Places places(experiment);
  for (int a = 0; a < static_cast<int>(experiment.bodies.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(experiment.bodies.size()); ++b) {
      const Box shared =
          common(bounds_of(experiment, experiment.bodies[a]), bounds_of(experiment, experiment.bodies[b]));
      if (!has_volume(experiment, shared)) continue;
      const auto most_may_lie_in = [&](int body) {
        return 2 * count_within(places.of(body), shared, experiment.dimension) > places.of(body).size();
      };
      if (!most_may_lie_in(a) && !most_may_lie_in(b)) continue;
      Overlap overlap{a, b, places.bins_of(b).count_near(places.of(a), half),
                      places.bins_of(a).count_near(places.of(b), half)};
      const std::size_t first = places.of(a).size(), second = places.of(b).size();
      if (2 * overlap.of_first <= first && 2 * overlap.of_second <= second) continue;
      overlap.identical = first == second && places.bins_of(a).count_near(places.of(b), same_place) == second &&
                          places.bins_of(b).count_near(places.of(a), same_place) == first;
      found.push_back(overlap);
    }
  return found;
}

std::string Overlap::text(const Experiment& experiment) const {
  const std::string a = in_quotes(experiment.bodies[first].name), b = in_quotes(experiment.bodies[second].name);
  if (identical)
    return "body " + b + " has the particles of body " + a + " in the very same places, " + std::to_string(of_first) +
           " of them; move one of them, or remove it";
  return "bodies " + a + " and " + b + " begin in one place: " + std::to_string(of_first) + " particles of " + a +
         " lie in " + b + ", and " + std::to_string(of_second) + " of " + b + " in " + a +
         ", so that the mass is there twice; move one of them, or cut it out with the geometry \"difference\" "
         "(docs/experiment_file.md#bodies)";
}

std::vector<RigidOverlap> rigid_overlaps_of(const Experiment& experiment) {
  std::vector<RigidOverlap> found;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
    for (int rigid = 0; rigid < static_cast<int>(experiment.rigid_bodies.size()); ++rigid) {
      const Geometry& geometry = *experiment.rigid_bodies[static_cast<std::size_t>(rigid)].geometry;
      const auto [lower, upper] = geometry.bounds();
      const Box of_body = bounds_of(experiment, experiment.bodies[static_cast<std::size_t>(body)]);
      if (!has_volume(experiment, common(of_body, {lower, upper}))) continue;
      note_overlap(experiment, {body, rigid}, found);
    }
  for (std::size_t emitter = 0; emitter < experiment.emitters.size(); ++emitter) {
    const Experiment filled = filled_by(experiment, experiment.emitters[emitter]);
    for (int rigid = 0; rigid < static_cast<int>(experiment.rigid_bodies.size()); ++rigid)
      if (!experiment.rigid_bodies[static_cast<std::size_t>(rigid)].moves())  // else it may be elsewhere by then
        note_overlap(filled, {experiment.emitters[emitter].body, rigid, static_cast<int>(emitter)}, found);
  }
  return found;
}

std::string RigidOverlap::text(const Experiment& experiment) const {
  std::ostringstream words;
  words << particles << " particles of ";
  if (emitter < 0)
    words << "body " << in_quotes(experiment.bodies[static_cast<std::size_t>(body)].name);
  else
    words << "each batch of emitter " << in_quotes(experiment.emitters[static_cast<std::size_t>(emitter)].name);
  words << " begin inside rigid body " << in_quotes(experiment.rigid_bodies[static_cast<std::size_t>(rigid_body)].name)
        << ", the deepest " << std::setprecision(3) << deepest
        << " m below its surface: a law of contact stops what approaches and pushes nothing out; move one of them, or "
        << "cut out what is in both with the geometry \"difference\" (docs/experiment_file.md#rigid-bodies)";
  return words.str();
}

}  // namespace mpm::app
