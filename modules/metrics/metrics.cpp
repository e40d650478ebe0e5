#include "metrics/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/body_sums.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/offers_totals.hpp"
#include "simulation/particle_changes.hpp"

namespace mpm {
namespace {

constexpr std::string_view book_suffix = " book";
bool is_book(const ValueRow& row) {
  return row.name.ends_with(book_suffix);
}

/// Whether a row of a ledger is that of particles that come, go or change, and none do.
bool nobody_exchanges(const Experiment& experiment, const std::string& name) {
  const auto becomes = [](const BodySpecification& body) { return body.becomes.has_value(); };
  return (name == "emitted" && experiment.emitters.empty()) || (name == "removed" && experiment.sinks.empty()) ||
         (name == "changed material" && std::none_of(experiment.bodies.begin(), experiment.bodies.end(), becomes));
}

/// Whether a row of a ledger is that of a cause by which no material dissipates.
bool nobody_dissipates(const Experiment& experiment, const std::string& name) {
  const auto& materials = experiment.materials;
  if (name == name_of(&Ledger::phase_change))
    return std::none_of(materials.begin(), materials.end(), [](const MaterialSpecification& material) {
      return material.thermal && material.thermal->phase_change;
    });
  for (double Ledger::*const row : dissipation_rows)
    if (name == name_of(row))
      return std::none_of(materials.begin(), materials.end(), [&](const MaterialSpecification& material) {
        return dissipation_of(*material.component.plugin) == row;
      });
  return false;
}

/// Whether the kinetic energy of a particle depends on its place in a cell.
bool moves_second_moment(const Experiment& experiment, const Plan& plan) {
  const bool carries = experiment.transfer.plugin->transfer().traits & MPM_AFFINE_CARRIES_ENERGY;
  const bool varies = experiment.shape.plugin->shape().second_moment_kind != MPM_MOMENT_CONSTANT;
  return (carries && varies) || plan.basis_functions > 0;
}

}  // namespace

Metrics::Metrics(const Simulation& simulation) : simulation_(simulation), chosen_(simulation) {
  const Experiment& experiment = simulation.experiment();
  if (experiment.exact)
    for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
      start_.push_back(simulation.backend().body_state(body));
  initial_ = measure();
}

Totals Metrics::measure() const {
  Totals totals = no_totals(simulation_.experiment());
  totals.time = simulation_.time();
  totals.time_step = simulation_.last_time_step();
  totals.step = simulation_.steps();
  for (int body = 0; body < static_cast<int>(simulation_.experiment().bodies.size()); ++body) add_body(body, totals);
  refer_to_centre_of_mass(totals);
  const double count = static_cast<double>(simulation_.particle_count());
  totals.position_error_rms = std::sqrt(totals.position_error_rms / count);
  totals.velocity_error_rms = std::sqrt(totals.velocity_error_rms / count);
  return totals;
}

/// Errors against an exact solution are of single particles, whose state is read for them, and then gives the sums too.
bool Metrics::add_offered(int body, Totals& totals) const {
  const auto* const offers = dynamic_cast<const OffersTotals*>(&simulation_.backend());
  if (!offers || !start_.empty()) return false;
  if (const std::optional<Totals> sums = offers->totals_of(body)) add_sums(*sums, totals);
  return true;
}

void Metrics::add_body(int body, Totals& totals) const {
  if (add_offered(body, totals)) return;
  const BodyView view(simulation_, body);
  for (std::size_t p = 0; p < view.count; ++p) add_particle(view, p, totals);
  for (std::size_t p = 0; view.experiment.has_temperature() && p < view.count; ++p) add_heat(view, p, totals);
  if (!start_.empty()) add_errors(body, view.state, totals);
}

void Metrics::add_errors(int body, const BodyState& state, Totals& totals) const {
  const Experiment& experiment = simulation_.experiment();
  const int D = experiment.dimension;
  const auto exact = make_exact_solution(experiment, simulation_.last_time_step());
  const BodyState& start = start_[body];
  for (std::size_t p = 0; p < state.position.size() / D; ++p) {
    Vector3 X{}, V{};
    std::copy_n(&(start.initial_position.empty() ? start.position : start.initial_position)[p * D], D, X.begin());
    std::copy_n(&start.velocity[p * D], D, V.begin());
    const Vector3 x = exact->position(X, V, simulation_.time()), v = exact->velocity(X, V, simulation_.time());
    double dx = 0, dv = 0;
    for (int c = 0; c < D; ++c) {
      dx += std::pow(state.position[p * D + c] - x[c], 2);
      dv += std::pow(state.velocity[p * D + c] - v[c], 2);
    }
    totals.position_error_rms += dx;
    totals.velocity_error_rms += dv;
    totals.position_error_max = largest_of(totals.position_error_max, std::sqrt(dx));
    totals.velocity_error_max = largest_of(totals.velocity_error_max, std::sqrt(dv));
  }
}

double Metrics::ledger_residual(const Totals& now) const {
  if (!simulation_.plan().has_ledger()) return 0;
  return now.total_energy() - initial_.total_energy() - simulation_.ledger().explained();
}

double Metrics::heat_residual(const Totals& now) const {
  if (!simulation_.plan().has_heat_ledger()) return 0;
  const double gained = now.heat_content - initial_.heat_content + (now.latent_heat - initial_.latent_heat);
  return gained - simulation_.heat_ledger().sum();
}

std::vector<ValueRow> Metrics::ledger_rows(const Totals& now) const {
  const Plan& plan = simulation_.plan();
  if (!plan.has_ledger()) return {};
  std::vector<ValueRow> rows = rows_of(simulation_.ledger());
  const bool takes_back = plan.resolves_contact() && gather_shares(simulation_.experiment()).of_velocity < 1;
  bool gravity_without_potential = false, falls = false;
  for (int axis = 0; axis < simulation_.experiment().dimension; ++axis)
    if (simulation_.experiment().has_gravity(axis))
      (simulation_.experiment().gravity_has_potential(axis) ? falls : gravity_without_potential) = true;
  const bool remaps = simulation_.experiment().solver.stress_update == StressUpdate::modified_last;
  const auto nothing_gives = [&](const std::string& name) {
    for (const ExternalForce force : external_forces)
      if (force != ExternalForce::body_force && name == name_of(force))
        return simulation_.experiment().giver_of(force).empty();
    return false;
  };
  std::erase_if(rows, [&](const ValueRow& row) {
    return is_book(row) || nothing_gives(row.name) || nobody_exchanges(simulation_.experiment(), row.name) ||
           (!plan.filters() && (row.name == "filter" || row.name == "filtered strain")) ||
           (!(plan.filters() && falls) && row.name == "filtered gravity") ||
           (!simulation_.experiment().damping.acts() && row.name == "damping") ||
           (!simulation_.experiment().has_artificial_viscosity() && row.name == "artificial viscosity") ||
           nobody_dissipates(simulation_.experiment(), row.name) || (!remaps && row.name == "remapped strain") ||
           (simulation_.experiment().rigid_bodies.empty() && row.name == "rigid bodies") ||
           (!simulation_.experiment().has_compliant_contact() && row.name == "interface springs") ||
           (!moves_second_moment(simulation_.experiment(), plan) && row.name == "second moment") ||
           (!gravity_without_potential && row.name == "gravity without potential") ||
           (!takes_back && row.name == "friction taken back");
  });
  rows.push_back({"residual", "J", ledger_residual(now), true});
  return rows;
}

std::vector<ValueRow> Metrics::book_rows() const {
  if (!simulation_.plan().has_ledger()) return {};
  std::vector<ValueRow> rows = rows_of(simulation_.ledger());
  std::erase_if(rows, [&](const ValueRow& row) {
    return !is_book(row) || (!simulation_.plan().filters() && row.name == "filter book");
  });
  for (ValueRow& row : rows) row.name.resize(row.name.size() - book_suffix.size());
  return rows;
}

std::vector<ValueRow> Metrics::heat_ledger_rows(const Totals& now) const {
  if (!simulation_.plan().has_heat_ledger()) return {};
  std::vector<ValueRow> rows = rows_of(simulation_.heat_ledger());
  std::erase_if(rows, [&](const ValueRow& row) { return nobody_exchanges(simulation_.experiment(), row.name); });
  rows.push_back({"residual", "J", heat_residual(now), true});
  return rows;
}

std::vector<ValueRow> Metrics::rows(const Totals& t) const {
  const Experiment& experiment = simulation_.experiment();
  const Plan& plan = simulation_.plan();
  const RecordedUnits units = units_of(experiment);
  const bool flat = units.flat;
  const std::string &energy = units.energy, &momentum = units.momentum, &spin = units.spin, &force = units.force,
                    norm = std::string("kg^0.5 m/s") + (flat ? " per m^0.5" : "");
  const auto [first, first_spin] = recorded_axes(experiment);
  std::vector<ValueRow> rows;
  const auto add = [&](const std::string& name, const std::string& unit, double value) {
    rows.push_back({name, unit, value});
  };
  const auto add_components = [&](const std::string& name, const std::string& unit, const std::array<double, 3>& values,
                                  int begin, int end) {
    for (int c = begin; c < end; ++c) add(name + " " + "xyz"[c], unit, values[static_cast<std::size_t>(c)]);
  };
  const auto add_ledger = [&](const std::string& ledger, const std::vector<ValueRow>& entries) {
    for (const ValueRow& entry : entries)
      add(ledger + " " + entry.name,
          entry.unit == "J"            ? energy
          : entry.unit == "kg" && flat ? "kg/m"
          : entry.unit == "kg"         ? entry.unit
                                       : momentum,
          entry.value);
  };
  add("time", "s", t.time);
  add("step", "", static_cast<double>(t.step));
  add("time step", "s", t.time_step);
  add("kinetic energy", energy, t.kinetic);
  add("strain energy", energy, t.strain);
  add("gravitational energy", energy, t.gravitational);
  add("total energy", energy, t.total_energy());
  add_ledger("ledger", ledger_rows(t));
  add_ledger("book", book_rows());
  add_components("momentum", momentum, t.momentum, first, experiment.dimension);
  add_components("angular momentum", spin, t.angular_momentum, first_spin, 3);
  add_components("centre of mass", "m", t.centre_of_mass, first, experiment.dimension);
  if (const ParticleChanges* const changes = simulation_.particle_changes()) {
    add("particles", "", static_cast<double>(simulation_.particle_count()));
    add("mass", units.mass, t.mass);
    for (const auto& [name, exchange] :
         {std::pair{"emitted", &changes->emitted()}, std::pair{"removed", &changes->removed()}}) {
      if (nobody_exchanges(experiment, name)) continue;
      add(std::string(name) + " mass", units.mass, exchange->mass);
      add_components(std::string(name) + " momentum", momentum, exchange->momentum, first, experiment.dimension);
    }
    if (!nobody_exchanges(experiment, "changed material")) add("changed particles", "", changes->changed().particles);
  }
  add("smallest volume ratio", "", t.smallest_volume_ratio);
  add("largest volume ratio", "", t.largest_volume_ratio);
  add("largest speed", "m/s", t.largest_speed);
  if (plan.resolves_contact()) {
    const ContactRecord& contact = simulation_.backend().contact_record();
    add_components("contact force", force, contact.force, first, experiment.dimension);
    add("contact nodes", "", static_cast<double>(contact.nodes));
    add("sticking nodes", "", static_cast<double>(contact.sticking));
    add("slipping nodes", "", static_cast<double>(contact.slipping));
    add("largest penetration", "m", contact.largest_penetration);
  }
  const std::vector<Support> supports = experiment.supports();
  for (const int asked : experiment.output.reactions) {
    const Reaction& reaction = simulation_.backend().reactions()[static_cast<std::size_t>(asked)];
    const std::string name = "reaction " + supports[static_cast<std::size_t>(asked)].name;
    add_components(name, force, reaction.force, first, experiment.dimension);
    add_components(name + " moment", flat ? "N m/m" : "N m", reaction.moment, first_spin, 3);
  }
  for (std::size_t k = 0; k < experiment.rigid_bodies.size(); ++k) {
    const Backend& backend = simulation_.backend();
    const Reaction& reaction = backend.reactions()[static_cast<std::size_t>(experiment.support_of_rigid_body(k))];
    const RigidState& state = backend.rigid_bodies()[k];
    const std::string name = "rigid " + experiment.rigid_bodies[k].name;
    add_components(name + " force", force, state.force_on(reaction), first, experiment.dimension);
    add_components(name + " torque", flat ? "N m/m" : "N m", state.torque_on(reaction), first_spin, 3);
    add_components(name + " place", "m", state.place, first, experiment.dimension);
  }
  if (plan.filters()) {
    const FilterRecord& filter = simulation_.backend().filter_record();
    add("filter increment norm", norm, filter.last_norm);
    add("filter iterations", "", static_cast<double>(filter.iterations));
  }
  if (experiment.has_temperature()) {
    add("heat content", energy, t.heat_content);
    add("latent heat", energy, t.latent_heat);
    add("lowest temperature", "K", t.lowest_temperature);
    add("highest temperature", "K", t.highest_temperature);
  }
  add_ledger("heat ledger", heat_ledger_rows(t));
  if (experiment.exact) {
    add("position error rms", "m", t.position_error_rms);
    add("position error max", "m", t.position_error_max);
    add("velocity error rms", "m/s", t.velocity_error_rms);
    add("velocity error max", "m/s", t.velocity_error_max);
  }
  for (ChosenRow& row : chosen_.rows()) rows.push_back(std::move(row.row));
  return rows;
}

std::vector<std::string> Metrics::columns() const {
  std::vector<std::string> names;
  for (const ValueRow& row : rows(initial_)) names.push_back(heading(row));
  return names;
}

std::vector<double> Metrics::row(const Totals& totals) const {
  std::vector<double> values;
  for (const ValueRow& row : rows(totals)) values.push_back(row.value);
  return values;
}

}  // namespace mpm
