#include "run/summary.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include "bench/costs.hpp"
#include "experiment/diagnostics.hpp"
#include "output/summary_value.hpp"
#include "run/books.hpp"
#include "run/rim_steps.hpp"
#include "run/tent_steps.hpp"
#include "simulation/boundary.hpp"

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

Json energy(const Simulation& simulation, const Metrics& metrics, const Recorder& recorder) {
  const Totals &start = metrics.initial(), &end = recorder.latest();
  Json json{{"kinetic", change(start.kinetic, end.kinetic)},
            {"strain", change(start.strain, end.strain)},
            {"gravitational", change(start.gravitational, end.gravitational)},
            {"total", change(start.total_energy(), end.total_energy())}};
  json["total"]["largest"] = recorder.largest_total_energy();
  if (start.total_energy() != 0)
    json["total"]["largest_over_initial"] = recorder.largest_total_energy() / start.total_energy();
  if (const double scale = available_energy(simulation.experiment(), start); scale > 0)
    json["total"]["gain"] = (recorder.largest_total_energy() - start.total_energy()) / scale;
  if (!simulation.plan().has_ledger()) return json;
  for (const ValueRow& row : metrics.ledger_rows(end)) json["ledger"][key_of(row)] = row.value;
  for (const ValueRow& row : metrics.book_rows()) json["books"][key_of(row)] = row.value;
  if (const int every = simulation.plan().ledger_every; every > 1) json["ledger_every"] = every;
  return json;
}

Json heat(const Metrics& metrics, const Totals& end) {
  const Totals& start = metrics.initial();
  Json json{{"content", change(start.heat_content, end.heat_content)},
            {"latent", change(start.latent_heat, end.latent_heat)},
            {"lowest_temperature", end.lowest_temperature},
            {"highest_temperature", end.highest_temperature}};
  for (const ValueRow& row : metrics.heat_ledger_rows(end)) json["ledger"][key_of(row)] = row.value;
  return json;
}

void collect_names(const Json& value, const std::string& prefix, std::vector<std::string>& names) {
  if (value.is_number()) names.push_back(prefix);
  if (!value.is_object()) return;
  for (const auto& [key, child] : value.items()) collect_names(child, prefix.empty() ? key : prefix + "." + key, names);
}

/// What mirror images made of the heat at walls with convection, where the particles keep it; empty where that is
/// little. No warning is due where walls hold a temperature, as images are a part of the heat through those.
std::string warning_of_images(const Simulation& simulation) {
  const auto& faces = simulation.experiment().faces;
  const auto any = [&](auto is) {
    return std::any_of(std::begin(faces), std::end(faces), [&](auto& sides) { return is(sides[0]) || is(sides[1]); });
  };
  if (!simulation.plan().has_heat_ledger() || any([](auto& face) { return holds_temperature(face); })) return "";
  if (!any([](auto& face) { return face.thermal.exchange == HeatExchange::convection; })) return "";
  const HeatLedger& heat = simulation.backend().heat_ledger();
  const double share = (heat.scatter + heat.images + heat.gather) / std::abs(heat.convection);
  if (!(std::abs(share) > 0.05)) return "";
  std::ostringstream warning;
  warning << std::fixed << std::setprecision(0);
  warning << "mirror images " << (share < 0 ? "took" : "gave") << " heat of " << 100 * std::abs(share)
          << " % of what convection brought: transfer "
          << std::quoted(std::string(simulation.experiment().transfer.plugin->id()))
          << " keeps what they do in every step; take longer steps, or transfer \"flip\" or \"aflip\"";
  return warning.str();
}

std::string warning_of_ledger(const Simulation& simulation, const Recorder& recorder, const Totals& start) {
  if (!simulation.plan().has_ledger()) return "";
  const bool single = simulation.experiment().precision == Precision::single;
  return warning_of_books(simulation.ledger(),
                          {single ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon(),
                           static_cast<double>(simulation.steps()),
                           std::max(std::abs(start.total_energy()), std::abs(recorder.largest_total_energy())),
                           start.mass, recorder.momentum_scale()});
}

Json warnings(const Simulation& simulation, const Recorder& recorder, const Totals& start) {
  Json all = Json::array();
  if (recorder.most_contact_nodes() > 0)
    if (const std::string steps = warning_of_rim_steps(simulation.experiment()); !steps.empty()) all.push_back(steps);
  if (const std::string tents = warning_of_tent_steps(simulation.experiment()); !tents.empty()) all.push_back(tents);
  if (const std::string books = warning_of_ledger(simulation, recorder, start); !books.empty()) all.push_back(books);
  if (const std::string images = warning_of_images(simulation); !images.empty()) all.push_back(images);
  if (const double growth = simulation.backend().filter_record().largest_growth; growth > 1 + 1e-9) {
    std::ostringstream warning;
    warning.precision(6);
    warning << "the filter's increment grew by a factor of up to " << growth
            << " in one pass: its loop no longer contracts, because constraints or negative weights broke it; filter "
               "with fewer passes or with /filter/constraints \"at_end\"";
    all.push_back(warning.str());
  }
  constexpr long enough = 10;
  const Plan& plan = simulation.plan();
  const long entries = plan.accounts_within(simulation.steps());
  if (plan.ledger_every > 1 && entries < enough)
    all.push_back("the ledger is of " + std::to_string(entries) + " of " + std::to_string(simulation.steps()) +
                  " steps, too few to say where the energy went; lower /output/ledger_every");
  return all;
}

}  // namespace

Json record_of(const Failure& failure, const FailurePlace& place, const Experiment& experiment) {
  Json record{{"cause", name_of(failure.cause)},
              {"where",
               {{"step", place.step},
                {"time", place.time},
                {"body", experiment.bodies[failure.body].name},
                {"particle", failure.particle},
                {"position", place.position}}}};
  record["values"] = Json::array();
  for (const ValueRow& row : values_of(failure, experiment))
    record["values"].push_back({{"name", row.name}, {"unit", row.unit}, {"value", row.value}});
  record["remedy"] = remedy_for(failure);
  return record;
}

Json record_of(const ImposedHeat& imposed, long step) {
  Json record{
      {"cause", impossible_heat_cause},
      {"where",
       {{"step", step}, {"time", imposed.time}, {"condition", imposed.pointer}, {"position", imposed.position}}}};
  record["values"] = Json::array({{{"name", imposed.name}, {"unit", imposed.unit}, {"value", imposed.value}}});
  record["remedy"] = impossible_heat_remedy;
  return record;
}

Json summarise(const Simulation& simulation, const Metrics& metrics, const Recorder& recorder, double wall_seconds,
               const EarlierParts& earlier) {
  const Experiment& experiment = simulation.experiment();
  const Totals &start = metrics.initial(), &end = recorder.latest();
  const auto [first, first_spin] = recorded_axes(experiment);
  const double particles = static_cast<double>(simulation.particle_count());
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
  if (experiment.has_temperature()) json["heat"] = heat(metrics, end);
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
  json["centre_of_mass"] = {{"initial", by_axis(start.centre_of_mass, first, experiment.dimension)},
                            {"final", by_axis(end.centre_of_mass, first, experiment.dimension)}};
  if (simulation.plan().resolves_contact()) {
    const ContactRecord& contact = simulation.backend().contact_record();
    json["contact"] = {{"largest_force", recorder.largest_contact_force()},
                       {"most_nodes", recorder.most_contact_nodes()},
                       {"largest_penetration", recorder.largest_penetration()},
                       {"final_nodes", contact.nodes},
                       {"momentum_residual", contact.momentum_residual}};
  }
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
                         {"particle_steps", particles * static_cast<double>(simulation.steps())},
                         {"particle_steps_per_second",
                          stepping > 0 ? particles * static_cast<double>(simulation.steps()) / stepping : 0.0},
                         {"bytes_per_particle", static_cast<double>(simulation.backend().particle_bytes()) / particles},
                         {"grid_bytes", simulation.backend().grid_bytes()},
                         {"peak_memory", peak_memory()}};
  // Operations are those of the algorithm, counted: null where the counter does not know a part of them.
  const auto flops = bench::flops_per_particle(experiment, simulation.plan(), bench::facts_of(simulation));
  json["performance"]["flops"] =
      flops ? Json(flops->total() * particles * static_cast<double>(simulation.steps())) : Json();
  for (const auto& [name, seconds] : seconds_by_pass) json["performance"]["seconds_by_pass"][name] = seconds;
  if (!earlier.resumed_from_steps.empty()) json["performance"]["resumed_from_step"] = earlier.resumed_from_steps;
  json["warnings"] = warnings(simulation, recorder, start);
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
        std::vector<std::string> names;
        collect_names(summary, "", names);
        sentence << ", but the summary has no number of that name" << did_you_mean(expectation.metric, names);
      }
      failed.push_back(sentence.str());
    }
    summary["expect"].push_back(entry);
  }
  return failed;
}

}  // namespace mpm::app
