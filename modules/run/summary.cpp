#include "run/summary.hpp"

#include <sys/resource.h>

#include <cmath>
#include <sstream>

#include "bench/costs.hpp"
#include "experiment/diagnostics.hpp"
#include "metrics/body_sums.hpp"
#include "output/summary_value.hpp"
#include "run/limits.hpp"
#include "run/record_names.hpp"
#include "run/warnings.hpp"
#include "simulation/particle_changes.hpp"

namespace mpm::app {
namespace {

using Json = nlohmann::ordered_json;

Json change(double initial, double final) {
  Json json{{"initial", initial}, {"final", final}};
  if (initial != 0) json["final_over_initial"] = final / initial;
  return json;
}

Json by_axis(const std::array<double, 3>& values, int first, int last) {
  Json json = Json::object();
  for (int c = first; c < last; ++c) json[std::string(1, "xyz"[c])] = values[c];
  return json;
}

double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024;
}

/// The energy of the start, J, that could become kinetic; of gravity's, as far as the domain lets the mass fall.
double available_energy(const Experiment& experiment, const Totals& start) {
  double energy = start.kinetic + start.strain;
  for (int c = 0; c < experiment.dimension; ++c) {
    const double g = experiment.gravity[c], x = start.centre_of_mass[c];
    energy += start.mass * std::abs(g) * (g < 0 ? x - experiment.grid.lower[c] : experiment.grid.upper[c] - x);
  }
  return energy;
}

/// Writes the rows of a ledger, and which of them closes it.
void put_ledger(Json& json, const std::vector<ValueRow>& rows) {
  for (const ValueRow& row : rows) {
    json["ledger"][key_of(row)] = row.value;
    if (row.closes) json["ledger_closed_by"] = key_of(row);
  }
}

/// What an isolated scene gained at most, and lost in the end, as shares of the energy that it could have lost. Of a run
/// whose last step failed on its way there is no loss: the ledger holds a part of that step, the energies nothing of it.
void add_changes(const Simulation& simulation, const Metrics& metrics, const RunRecord& recorder, double scale,
                 Json& total) {
  total["gain"] = (recorder.largest_total_energy() - metrics.initial().total_energy()) / scale;
  if (!simulation.plan().has_ledger() || recorder.broken_off()) return;
  total["numerical_loss"] = -numerical_gain(simulation.ledger()) / scale;
  total["unexplained_loss"] = -metrics.ledger_residual(recorder.latest()) / scale;
}

Json energy(const Simulation& simulation, const Metrics& metrics, const RunRecord& recorder) {
  const Totals &start = metrics.initial(), &end = recorder.latest();
  Json json{{"kinetic", change(start.kinetic, end.kinetic)},
            {"strain", change(start.strain, end.strain)},
            {"gravitational", change(start.gravitational, end.gravitational)},
            {"total", change(start.total_energy(), end.total_energy())}};
  json["total"]["largest"] = recorder.largest_total_energy();
  if (start.total_energy() != 0)
    json["total"]["largest_over_initial"] = recorder.largest_total_energy() / start.total_energy();
  if (const double scale = available_energy(simulation.experiment(), start); scale > 0)
    add_changes(simulation, metrics, recorder, scale, json["total"]);
  if (!simulation.plan().has_ledger() || recorder.broken_off()) return json;
  put_ledger(json, metrics.ledger_rows(end));
  for (const ValueRow& row : metrics.book_rows()) json["books"][key_of(row)] = row.value;
  if (const int every = simulation.plan().ledger_every; every > 1) json["ledger_every"] = every;
  return json;
}

Json heat(const Metrics& metrics, const RunRecord& recorder) {
  const Totals &start = metrics.initial(), &end = recorder.latest();
  Json json{{"content", change(start.heat_content, end.heat_content)},
            {"latent", change(start.latent_heat, end.latent_heat)},
            {"lowest_temperature", end.lowest_temperature},
            {"highest_temperature", end.highest_temperature}};
  if (!recorder.broken_off()) put_ledger(json, metrics.heat_ledger_rows(end));
  return json;
}

/// What the supports that were asked for did in the last step and, as a mean over time, since the run began.
Json reactions(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  const auto [first, first_spin] = recorded_axes(experiment);
  const std::vector<Support> supports = experiment.supports();
  Json json = Json::object();
  for (const int asked : experiment.output.reactions) {
    const Reaction& reaction = simulation.backend().reactions()[static_cast<std::size_t>(asked)];
    Vector3 mean = reaction.impulse;
    for (double& component : mean) component /= simulation.time();
    Json& entry = json[supports[static_cast<std::size_t>(asked)].name];
    entry["force"] = by_axis(reaction.force, first, experiment.dimension);
    entry["mean_force"] = by_axis(mean, first, experiment.dimension);
    if (first_spin < 3) entry["moment"] = by_axis(reaction.moment, first_spin, 3);
  }
  return json;
}

/// The force and torque on each rigid body in the last step, its force as a mean over time, and where it is.
Json rigid_bodies(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  const auto [first, first_spin] = recorded_axes(experiment);
  Json json = Json::object();
  for (std::size_t k = 0; k < experiment.rigid_bodies.size(); ++k) {
    const auto support = static_cast<std::size_t>(experiment.support_of_rigid_body(k));
    const Reaction& reaction = simulation.backend().reactions()[support];
    const RigidState& state = simulation.backend().rigid_bodies()[k];
    Vector3 mean = reaction.impulse;
    for (double& component : mean) component /= -simulation.time();
    Json& entry = json[experiment.rigid_bodies[k].name];
    entry["force"] = by_axis(state.force_on(reaction), first, experiment.dimension);
    entry["mean_force"] = by_axis(mean, first, experiment.dimension);
    if (first_spin < 3) entry["torque"] = by_axis(state.torque_on(reaction), first_spin, 3);
    entry["place"] = by_axis(state.place, first, experiment.dimension);
  }
  return json;
}

/// What emitters brought, sinks took and changes of material made, and whether the mass is what that leaves.
Json particle_changes(const Simulation& simulation, const Totals& start, const Totals& end) {
  const Experiment& experiment = simulation.experiment();
  const ParticleChanges& changes = *simulation.particle_changes();
  const int first = recorded_axes(experiment).linear;
  const double expected = start.mass + changes.emitted().mass - changes.removed().mass;
  Json json{{"mass", change(start.mass, end.mass)}};
  json["mass"]["residual"] = end.mass - expected;
  const auto put = [&](const char* name, const Exchange& exchange) {
    Json& entry = json[name] = {{"particles", exchange.particles}, {"energy", exchange.energy}};
    if (experiment.has_temperature()) entry["heat"] = exchange.heat;
    if (std::string_view(name) == "changed") return;
    entry["mass"] = exchange.mass;
    entry["momentum"] = by_axis(exchange.momentum, first, experiment.dimension);
  };
  if (!experiment.emitters.empty()) put("emitted", changes.emitted());
  if (!experiment.sinks.empty()) put("removed", changes.removed());
  for (const BodySpecification& body : experiment.bodies)
    if (body.becomes) put("changed", changes.changed());
  return json;
}

/// Puts the chosen numbers under their paths.
void add_chosen(const Metrics& metrics, const RunRecord& rows, Json& json) {
  if (rows.chosen().empty()) return;
  const auto& paths = metrics.chosen().paths();
  for (std::size_t k = 0; k < paths.size(); ++k) {
    Json* place = &json;
    for (const std::string& name : paths[k]) place = &(*place)[name];
    const RunRecord::Range& range = rows.chosen()[k];
    *place = {
        {"initial", range.initial}, {"final", range.latest}, {"smallest", range.smallest}, {"largest", range.largest}};
  }
}

}  // namespace

Json record_of(const Failure& failure, const FailurePlace& place, const Experiment& experiment) {
  Json record{{"cause", name_of(failure.cause)}, {"where", {{"step", place.step}, {"time", place.time}}}};
  if (is_of_a_particle(failure.cause))
    record["where"].update(
        {{"body", experiment.bodies[failure.body].name}, {"particle", failure.particle}, {"position", place.position}});
  record["values"] = Json::array();
  for (const ValueRow& row : values_of(failure, experiment))
    record["values"].push_back({{"name", row.name}, {"unit", row.unit}, {"value", row.value}});
  record["remedy"] = remedy_for(failure, experiment);
  return record;
}

Json record_of(const ImposedValue& imposed, long step) {
  Json record{{"cause", impossible_value_cause},
              {"where", {{"step", step}, {"time", imposed.time}, {"condition", imposed.pointer}}}};
  if (!imposed.position.empty()) record["where"]["position"] = imposed.position;
  record["values"] = Json::array({{{"name", imposed.name}, {"unit", imposed.unit}, {"value", imposed.value}}});
  record["remedy"] = impossible_value_remedy;
  return record;
}

Json summarise(const Simulation& simulation, const Metrics& metrics, const RunRecord& recorder, double wall_seconds,
               const EarlierParts& earlier) {
  const Experiment& experiment = simulation.experiment();
  const Totals &start = metrics.initial(), &end = recorder.latest();
  const auto [first, first_spin] = recorded_axes(experiment);
  const double particles = static_cast<double>(simulation.particle_count());
  const double particle_steps = simulation.particle_steps();
  std::map<std::string, double> seconds_by_pass = earlier.seconds_by_pass;
  for (const auto& [name, seconds] : simulation.seconds_by_pass()) seconds_by_pass[name] += seconds;
  double stepping = 0;
  for (const auto& [name, seconds] : seconds_by_pass) stepping += seconds;

  Json json{
      {"particles", simulation.particle_count()}, {"steps", simulation.steps()}, {"simulated_time", simulation.time()}};
  json["time_step"] = {{"min", simulation.smallest_time_step()}, {"max", simulation.largest_time_step()}};
  if (!simulation.limited_by().empty()) {
    json["time_step"]["limited_by"] = simulation.limited_by();
    json["time_step"]["smallest_limited_by"] = simulation.smallest_limited_by();
  }
  if (const std::string limiting = simulation.limiting_particle(); !limiting.empty())
    json["limiting_particle"] = limiting;
  json["energy"] = energy(simulation, metrics, recorder);
  if (experiment.has_temperature()) json["heat"] = heat(metrics, recorder);
  // A ratio of roundings says nothing: spin counts against mass, speed and size of the domain.
  const double size = experiment.grid.upper[0] - experiment.grid.lower[0];
  const double scale_of_spin = start.mass * start.largest_speed * size;
  json["momentum"]["linear"] = {{"initial", by_axis(start.momentum, first, experiment.dimension)},
                                {"final", by_axis(end.momentum, first, experiment.dimension)}};
  if (first_spin < 3)
    json["momentum"]["angular"] = {{"initial", by_axis(start.angular_momentum, first_spin, 3)},
                                   {"final", by_axis(end.angular_momentum, first_spin, 3)}};
  for (int c = first_spin; c < 3; ++c)
    if (std::abs(start.angular_momentum[c]) > 1e-9 * scale_of_spin)
      json["momentum"]["angular"]["final_over_initial"][std::string(1, "xyz"[c])] =
          end.angular_momentum[c] / start.angular_momentum[c];
  json["scales"] = {{"momentum", recorder.momentum_scale()}, {"angular_momentum", recorder.angular_momentum_scale()}};
  json["mass"] = start.mass;
  if (simulation.particle_changes()) json["particle_changes"] = particle_changes(simulation, start, end);
  json["centre_of_mass"] = {{"initial", by_axis(start.centre_of_mass, first, experiment.dimension)},
                            {"final", by_axis(end.centre_of_mass, first, experiment.dimension)}};
  if (simulation.plan().resolves_contact()) {
    const ContactRecord& contact = simulation.backend().contact_record();
    json["contact"] = {{"largest_force", recorder.largest_contact_force()},
                       {"most_nodes", recorder.most_contact_nodes()},
                       {"largest_penetration", recorder.largest_penetration()},
                       {"final_nodes", contact.nodes},
                       {"momentum_residual", contact.momentum_residual}};
    json["contact"]["first_time"] =
        std::isnan(recorder.first_contact_time()) ? Json() : Json(recorder.first_contact_time());
  }
  if (!experiment.output.reactions.empty()) json["reaction"] = reactions(simulation);
  if (!experiment.rigid_bodies.empty()) json["rigid"] = rigid_bodies(simulation);
  if (experiment.exact)
    json["error"] = {{"position", {{"rms", end.position_error_rms}, {"max", end.position_error_max}}},
                     {"velocity", {{"rms", end.velocity_error_rms}, {"max", end.velocity_error_max}}}};
  json["stability"] = {{"smallest_volume_ratio", recorder.smallest_volume_ratio()},
                       {"largest_volume_ratio", recorder.largest_volume_ratio()},
                       {"largest_speed", end.largest_speed}};
  if (simulation.plan().filters()) {
    const FilterRecord& filter = simulation.backend().filter_record();
    json["stability"]["filter"] = {{"iterations", filter.iterations},
                                   {"increment_norm", filter.last_norm},
                                   {"largest_growth", filter.largest_growth}};
  }
  json["performance"] = {{"wall_seconds", earlier.wall_seconds + wall_seconds},
                         {"stepping_seconds", stepping},
                         {"particle_steps", particle_steps},
                         {"particle_steps_per_second", stepping > 0 ? particle_steps / stepping : 0.0},
                         {"bytes_per_particle", static_cast<double>(simulation.backend().particle_bytes()) / particles},
                         {"grid_bytes", simulation.backend().grid_bytes()},
                         {"peak_memory", peak_memory()}};
  // Operations are those of the algorithm, counted: null where the counter does not know a part of them.
  const auto flops = bench::flops_per_particle(experiment, simulation.plan(), bench::facts_of(simulation));
  json["performance"]["flops"] = flops ? Json(flops->total() * particle_steps) : Json();
  for (const auto& [name, seconds] : seconds_by_pass) json["performance"]["seconds_by_pass"][name] = seconds;
  if (!earlier.resumed_from_steps.empty()) json["performance"]["resumed_from_step"] = earlier.resumed_from_steps;
  add_chosen(metrics, recorder, json);
  json["warnings"] = warnings_of(simulation, metrics, recorder, json);
  return json;
}

std::vector<std::string> judge_expectations(const Experiment& experiment, Json& summary) {
  std::vector<std::string> failed;
  for (const Expectation& expectation : experiment.expectations) {
    const Json* value = output::value_at(summary, expectation.metric);
    const bool measured = value && value->is_number();
    const double x = measured ? value->get<double>() : NAN;
    bool held = measured;
    std::ostringstream wanted;
    Json entry{{"metric", expectation.metric}};
    if (expectation.at_least)
      wanted << " at least " << *expectation.at_least, held = held && x >= *expectation.at_least,
                                                       entry["at_least"] = *expectation.at_least;
    if (expectation.at_most)
      wanted << " at most " << *expectation.at_most, held = held && x <= *expectation.at_most,
                                                     entry["at_most"] = *expectation.at_most;
    if (expectation.equals) {
      wanted << " " << *expectation.equals << " within " << expectation.tolerance;
      held = held && std::abs(x - *expectation.equals) <= expectation.tolerance;
      entry["equals"] = *expectation.equals, entry["tolerance"] = expectation.tolerance;
    }
    entry["value"] = measured ? Json(x) : Json(nullptr);
    entry["held"] = held;
    if (!held) {
      std::ostringstream sentence;
      sentence << experiment.where(expectation.pointer) << ": " << expectation.pointer << ": expected "
               << expectation.metric << wanted.str();
      if (measured) {
        sentence << ", got " << x;
      } else {
        const std::vector<std::string> names = paths_of(summary);
        sentence << ", but the summary has no number of that name" << did_you_mean(expectation.metric, names);
      }
      failed.push_back(sentence.str());
    }
    summary["expect"].push_back(entry);
  }
  return failed;
}

}  // namespace mpm::app
