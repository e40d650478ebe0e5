#include "metrics/chosen_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/pair_surfaces.hpp"
#include "metrics/probes.hpp"
#include "metrics/rigid_gap.hpp"
#include "simulation/contact_impulse.hpp"

namespace mpm {
namespace {

/// Appends rows whose names begin alike.
struct Adder {
  std::string prefix;
  std::vector<std::string> path;
  std::vector<ChosenRow>& rows;

  void operator()(const std::string& name, const std::string& unit, double value) const {
    std::vector<std::string> place = path;
    place.push_back(key_of({name, "", 0}));
    rows.push_back({std::move(place), {prefix + name, unit, value}});
  }
  void components(const std::string& name, const std::string& unit, const std::array<double, 3>& values, int begin,
                  int end) const {
    for (int c = begin; c < end; ++c) (*this)(name + " " + "xyz"[c], unit, values[static_cast<std::size_t>(c)]);
  }
};

Vector3 place_of(const BodyState& state, std::size_t p, int dimension) {
  Vector3 x{};
  for (int c = 0; c < dimension; ++c) x[c] = state.position[p * static_cast<std::size_t>(dimension) + c];
  return x;
}

/// The size of a force that acts while the gap is open, before the surfaces meet; not a number where no gap is known.
double early_force(double gap, const Vector3& force) {
  return std::isnan(gap) ? gap : gap > 0 ? std::hypot(force[0], force[1], force[2]) : 0;
}

/// How many particles the backend has: fewer than were seeded where only the names of records are asked for.
std::size_t particles_of(const BodyState& state, int dimension) {
  return state.position.size() / static_cast<std::size_t>(dimension);
}

}  // namespace

ChosenNumbers::ChosenNumbers(const Simulation& simulation) : simulation_(simulation) {
  choose_parts();
  follow();
  for (ChosenRow& row : rows()) paths_.push_back(std::move(row.path));
}

void ChosenNumbers::choose_parts() {
  const Experiment& experiment = simulation_.experiment();
  const std::size_t bodies = experiment.bodies.size();
  for (const int body : experiment.output.bodies) {
    const std::string& name = experiment.bodies[body].name;
    parts_.emplace_back(Part{"body " + name + " ", {"bodies", name}, {}, body});
  }
  for (const GroupSpecification& group : experiment.output.groups) {
    Part& part = parts_.emplace_back(Part{"group " + group.name + " ", {"groups", group.name}, {}});
    part.particles.resize(bodies);
    for (int body = 0; body < static_cast<int>(bodies); ++body) {
      if (group.body >= 0 && group.body != body) continue;
      const BodyState state = simulation_.backend().body_state(body);
      for (std::size_t p = 0; p < particles_of(state, experiment.dimension); ++p)
        if (group.where->contains(place_of(state, p, experiment.dimension))) part.particles[body].push_back(p);
    }
  }
}

/// Finds the particle that begins nearest to each point. Of those that are equally near, but for rounding, the first.
void ChosenNumbers::follow() {
  const Experiment& experiment = simulation_.experiment();
  constexpr double rounding = 1e-5;
  for (const ProbeSpecification& probe : experiment.output.probes) {
    if (probe.kind != ProbeKind::nearest) continue;
    Followed& found = followed_.emplace_back(Followed{&probe});
    double nearest = std::numeric_limits<double>::infinity();
    for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
      if (probe.body >= 0 && probe.body != body) continue;
      const BodyState state = simulation_.backend().body_state(body);
      const std::size_t n = state.position.size() / static_cast<std::size_t>(experiment.dimension);
      for (std::size_t p = 0; p < n; ++p) {
        const Vector3 x = place_of(state, p, experiment.dimension);
        const double d = std::hypot(x[0] - probe.point[0], x[1] - probe.point[1], x[2] - probe.point[2]);
        if (d < nearest - rounding * experiment.grid.cell_size) nearest = d, found.body = body, found.particle = p;
      }
    }
  }
}

std::vector<ChosenRow> ChosenNumbers::rows() const {
  std::vector<ChosenRow> rows;
  Views views(simulation_);
  for (const Part& part : parts_) add_part(part, views, rows);
  for (const ProbeSpecification& probe : simulation_.experiment().output.probes) add_probe(probe, views, rows);
  add_pairs(views, rows);
  if (simulation_.experiment().output.contact_pairs) add_rigid_gaps(views, rows);
  return rows;
}

void ChosenNumbers::add_part(const Part& part, Views& views, std::vector<ChosenRow>& rows) const {
  const Experiment& experiment = simulation_.experiment();
  const RecordedUnits units = units_of(experiment);
  const auto [first, first_spin] = recorded_axes(experiment);
  const int D = experiment.dimension;
  PartSums sums(experiment);
  if (part.whole_body >= 0)
    for (std::size_t p = 0; p < views.of(part.whole_body).count; ++p) sums.add(views.of(part.whole_body), p);
  for (int body = 0; body < static_cast<int>(part.particles.size()); ++body)
    for (const std::size_t p : part.particles[body]) sums.add(views.of(body), p);
  sums.finish();
  if (sums.totals.mass == 0) sums.forget_extremes();
  const Totals& t = sums.totals;
  Vector3 velocity = t.momentum;
  for (double& v : velocity) v /= t.mass;
  const auto I = sums.inertia();
  const Adder add{part.prefix, part.path, rows};
  add("mass", units.mass, t.mass);
  add("kinetic energy", units.energy, t.kinetic);
  add("strain energy", units.energy, t.strain);
  add("gravitational energy", units.energy, t.gravitational);
  add.components("momentum", units.momentum, t.momentum, first, D);
  add.components("centre of mass", "m", t.centre_of_mass, first, D);
  add.components("velocity", "m/s", velocity, first, D);
  add.components("angular momentum", units.spin, t.angular_momentum, first_spin, 3);
  add.components("moment of inertia", units.inertia, {I[0][0], I[1][1], I[2][2]}, first_spin, 3);
  add.components("angular velocity", "1/s", sums.angular_velocity(D), first_spin, 3);
  add("largest speed", "m/s", t.largest_speed);
  add("smallest volume ratio", "", t.smallest_volume_ratio);
  add("largest volume ratio", "", t.largest_volume_ratio);
  add("smallest pressure", "Pa", sums.smallest_pressure);
  add("largest pressure", "Pa", sums.largest_pressure);
  add("largest von Mises stress", "Pa", sums.largest_von_mises);
  if (!experiment.has_temperature()) return;
  add("heat content", units.energy, t.heat_content);
  add("latent heat", units.energy, t.latent_heat);
  add("lowest temperature", "K", t.lowest_temperature);
  add("highest temperature", "K", t.highest_temperature);
}

void ChosenNumbers::add_probe(const ProbeSpecification& probe, Views& views, std::vector<ChosenRow>& rows) const {
  const Experiment& experiment = simulation_.experiment();
  if (probe.kind == ProbeKind::line) return;
  if (probe.kind == ProbeKind::section) add_section(probe, views, rows);
  const Adder add{"probe " + probe.name + " ", {"probes", probe.name}, rows};
  for (const std::string& name : probe.quantities) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (probe.kind == ProbeKind::section) value = section_mean(views, probe, name);
    if (probe.kind == ProbeKind::place) value = values_along(views, name, probe.body, probe.point, probe.point, 1)[0];
    for (const Followed& followed : followed_)
      if (followed.probe == &probe && !bodies_with(experiment, followed.body, name).empty())
        value = views.values(followed.body, name)[followed.particle];
    add(name, describe_quantity(experiment, name).unit, value);
  }
}

void ChosenNumbers::add_section(const ProbeSpecification& probe, Views& views, std::vector<ChosenRow>& rows) const {
  const Experiment& experiment = simulation_.experiment();
  const RecordedUnits units = units_of(experiment);
  const auto [first, first_spin] = recorded_axes(experiment);
  const SectionSums sums = section_sums(views, probe);
  const Adder add{"probe " + probe.name + " ", {"probes", probe.name}, rows};
  add("area", units.area, sums.area);
  add.components("force", units.force, sums.force, first, experiment.dimension);
  add.components("moment", units.moment, sums.moment, first_spin, 3);
}

void ChosenNumbers::add_pairs(Views& views, std::vector<ChosenRow>& rows) const {
  const Experiment& experiment = simulation_.experiment();
  if (recorded_pairs(experiment) == 0) return;
  const RecordedUnits units = units_of(experiment);
  const int first = recorded_axes(experiment).linear;
  const bool with_surfaces = experiment.output.normal_error;
  const std::vector<PairSurfaces> surfaces =
      with_surfaces ? pair_surfaces(views, simulation_.backend().contact_nodes(), simulation_.last_time_step())
                    : std::vector<PairSurfaces>();
  for (int a = 0; a < experiment.field_count; ++a)
    for (int b = a + 1; b < experiment.field_count; ++b) {
      const PairRecord& pair = simulation_.backend().contact_pairs()[pair_index(a, b, experiment.field_count)];
      const std::string &of_a = experiment.field_names[a], &of_b = experiment.field_names[b];
      const Adder add{"pair " + of_a + " " + of_b + " ", {"pairs", of_a, of_b}, rows};
      add.components("force", units.force, pair.force, first, experiment.dimension);
      add("normal force", units.force, pair.normal_force);
      add.components("tangential force", units.force, pair.tangential_force, first, experiment.dimension);
      add("area", units.area, pair.area);
      add("nodes", "", static_cast<double>(pair.nodes));
      add("sticking nodes", "", static_cast<double>(pair.sticking));
      add("slipping nodes", "", static_cast<double>(pair.slipping));
      add("largest penetration", "m", pair.largest_penetration);
      add("largest gap", "m", pair.largest_gap);
      add.components("impulse", units.momentum, pair.impulse, first, experiment.dimension);
      add("normal impulse", units.momentum, pair.normal_impulse);
      add.components("tangential impulse", units.momentum, pair.tangential_impulse, first, experiment.dimension);
      const auto& [x, y, z] = pair.unbalanced_impulse;
      add("unbalanced impulse", units.momentum, std::hypot(x, y, z));
      if (!with_surfaces) continue;
      const PairSurfaces& known = surfaces[pair_index(a, b, experiment.field_count)];
      add("normal error", "deg", known.normal_error);
      add("largest normal error", "deg", known.largest_normal_error);
      add("surface misfit", "m", known.misfit);
      add("gap", "m", known.gap);
      // What pulls across an open gap is meant to.
      add("early force", units.force, pair.normal_force < 0 ? 0 : early_force(known.gap, pair.force));
    }
}

void ChosenNumbers::add_rigid_gaps(Views& views, std::vector<ChosenRow>& rows) const {
  const Experiment& experiment = simulation_.experiment();
  const Backend& backend = simulation_.backend();
  for (std::size_t k = 0; k < experiment.rigid_bodies.size(); ++k) {
    const std::string& name = experiment.rigid_bodies[k].name;
    const Reaction& reaction = backend.reactions()[static_cast<std::size_t>(experiment.support_of_rigid_body(k))];
    const double gap = rigid_gap(views, k, backend.rigid_bodies()[k]);
    const Adder add{"rigid " + name + " ", {"rigid", name}, rows};
    add("gap", "m", gap);
    add("early force", units_of(experiment).force, early_force(gap, reaction.force));
  }
}

Profile ChosenNumbers::profile(const ProbeSpecification& line) const {
  const Experiment& experiment = simulation_.experiment();
  const int D = experiment.dimension;
  Profile profile{{"time (s)", "distance (m)"}, {}};
  for (int c = 0; c < D; ++c) profile.columns.push_back(std::string(1, "xyz"[c]) + " (m)");
  const auto count = static_cast<std::size_t>(line.count);
  profile.rows.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(count - 1);
    Vector3 x{};
    double length = 0;
    for (int c = 0; c < D; ++c) {
      x[c] = line.point[c] + share * (line.end[c] - line.point[c]);
      length = std::hypot(length, line.end[c] - line.point[c]);
    }
    profile.rows[k] = {simulation_.time(), share * length};
    profile.rows[k].insert(profile.rows[k].end(), x.begin(), x.begin() + D);
  }
  Views views(simulation_);
  for (const std::string& name : line.quantities) {
    profile.columns.push_back(heading({name, describe_quantity(experiment, name).unit, 0}));
    const std::vector<double> values = values_along(views, name, line.body, line.point, line.end, line.count);
    for (std::size_t k = 0; k < count; ++k) profile.rows[k].push_back(values[k]);
  }
  return profile;
}

}  // namespace mpm
