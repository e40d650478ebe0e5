#include "run/warnings.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "experiment/diagnostics.hpp"
#include "metrics/particle_quantities.hpp"
#include "output/summary_value.hpp"
#include "run/books.hpp"
#include "run/limits.hpp"
#include "run/particle_cells.hpp"
#include "run/rim_steps.hpp"
#include "run/start_checks.hpp"
#include "run/tent_steps.hpp"
#include "simulation/boundary.hpp"
#include "simulation/particle_changes.hpp"
#include "simulation/seeding.hpp"

namespace mpm::app {
namespace {

using Json = nlohmann::ordered_json;

/// What the warnings of a run are made of.
struct Evidence {
  const Simulation& simulation;
  const Metrics& metrics;
  const RunRecord& rows;
  const Json& summary;

  const Experiment& experiment() const { return simulation.experiment(); }
  bool met() const { return rows.most_contact_nodes() > 0; }
};

std::string digits(double value, int count = 3) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", count, value);
  return text;
}

std::string rim_steps(const Evidence& run) {
  return run.met() ? warning_of_rim_steps(run.experiment()) : "";
}

std::string tent_steps(const Evidence& run) {
  return warning_of_tent_steps(run.experiment());
}

std::string books(const Evidence& run) {
  if (!run.simulation.plan().has_ledger() || run.rows.broken_off()) return "";
  const bool single = run.experiment().precision == Precision::single;
  const Totals& start = run.metrics.initial();
  const ParticleChanges* const changes = run.simulation.particle_changes();
  return warning_of_books(run.simulation.ledger(),
                          {single ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon(),
                           static_cast<double>(run.simulation.steps()),
                           std::max(std::abs(start.total_energy()), std::abs(run.rows.largest_total_energy())),
                           start.mass + (changes ? changes->emitted().mass : 0), run.rows.momentum_scale()});
}

/// What mirror images made of the heat at walls with convection, where the particles keep it; empty where that is
/// little. No warning is due where walls hold a temperature, as images are a part of the heat through those.
std::string images(const Evidence& run) {
  const auto& faces = run.experiment().faces;
  const auto any = [&](auto is) {
    return std::any_of(std::begin(faces), std::end(faces), [&](auto& sides) { return is(sides[0]) || is(sides[1]); });
  };
  if (!run.simulation.plan().has_heat_ledger() || run.rows.broken_off()) return "";
  if (any([](auto& face) { return holds_temperature(face); })) return "";
  if (!any([](auto& face) { return face.thermal.exchange == HeatExchange::convection; })) return "";
  const HeatLedger& heat = run.simulation.backend().heat_ledger();
  const double share = (heat.scatter + heat.images + heat.gather) / std::abs(heat.convection);
  if (!(std::abs(share) > 0.05)) return "";
  std::ostringstream warning;
  warning << std::fixed << std::setprecision(0);
  warning << "mirror images " << (share < 0 ? "took" : "gave") << " heat of " << 100 * std::abs(share)
          << " % of what convection brought: transfer "
          << std::quoted(std::string(run.experiment().transfer.plugin->id()))
          << " keeps what they do in every step; take longer steps, or transfer \"flip\" or \"aflip\" "
             "(docs/method.md#temperature)";
  return warning.str();
}

std::string filter_growth(const Evidence& run) {
  const double growth = run.simulation.backend().filter_record().largest_growth;
  if (!(growth > 1 + 1e-9)) return "";
  return "the filter's increment grew by a factor of up to " + digits(growth, 6) +
         " in one pass: its loop no longer contracts, because constraints or negative weights broke it; filter with "
         "a lower order (docs/studies/filtered_contact.md)";
}

std::string few_entries(const Evidence& run) {
  constexpr long enough = 10;
  const Plan& plan = run.simulation.plan();
  const long entries = plan.accounts_within(run.simulation.steps());
  if (plan.ledger_every <= 1 || entries >= enough) return "";
  return "the ledger is of " + std::to_string(entries) + " of " + std::to_string(run.simulation.steps()) +
         " steps, too few to say where the energy went; lower /output/ledger_every (docs/studies/ledger.md)";
}

/// Energy that went without a physical cause, where the file sets no limit to it.
std::string numerical_loss(const Evidence& run) {
  const double share = output::number_at(run.summary, "energy.total.numerical_loss");
  if (run.experiment().limits.numerical_loss || !(share > much_energy)) return "";
  if (!why_no_change_is_judged(run.experiment(), run.summary).empty()) return "";
  return digits(100 * share) +
         " % of the energy went in transfers, filters, at walls and in contact, without a physical cause: the rows of "
         "the ledger say where; take a transfer that loses less than \"" +
         std::string(run.experiment().transfer.plugin->id()) +
         "\", a better shape or smaller cells, or set /limits/numerical_loss (docs/experiment_file.md#limits)";
}

std::string unexplained_loss(const Evidence& run) {
  const double share = output::number_at(run.summary, "energy.total.unexplained_loss");
  if (run.experiment().limits.unexplained_loss || !(share > much_energy)) return "";
  if (!why_no_change_is_judged(run.experiment(), run.summary).empty()) return "";
  return digits(100 * share) +
         " % of the energy went in the integration over time: no row of the ledger explains it; take smaller steps "
         "(/solver/courant or /solver/time_step), or /output/ledger_every 1 where it is more "
         "(docs/method.md#the-energy-ledger)";
}

std::string coarse_contact(const Evidence& run) {
  const auto& contact = run.experiment().contact;
  if (!contact || !run.met() || contact->plugin->contact().traits & MPM_BYPASSES_DETECTION) return "";
  for (const BodySpecification& body : run.experiment().bodies)
    if (body.particles_per_cell_axis < 2)
      return "body \"" + body.name +
             "\" has one particle a cell and axis where bodies touch: such a surface is known to no better than a "
             "cell, and collisions lose much more energy than with two; set particles_per_cell_axis to 2 or more "
             "(docs/studies/extremes.md#how-many-particles-a-cell)";
  return "";
}

std::string sliding_block(const Evidence& run) {
  const BodySpecification* block = finite_block(run.experiment());
  if (!block || !(run.rows.seen().slide > run.experiment().grid.cell_size)) return "";
  return "body \"" + block->name + "\", a finite block, slid " + digits(run.rows.seen().slide) +
         " m in contact on B-splines: at its ends the normal of averaged volume gradients tilts, and drags it even "
         "without friction, on a finer grid too; take \"normal\": \"widest_gap\" in \"contact\" "
         "(docs/contact.md#a-block-that-ends-and-the-widest-gap)";
}

/// The share of the particles that ended in another cell than they began in.
double share_in_other_cells(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  const auto D = static_cast<std::size_t>(experiment.dimension);
  std::size_t moved = 0;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const std::vector<double> now = simulation.backend().body_state(body).position;
    const auto cell = [&](double x, std::size_t c) {
      return std::floor((x - experiment.grid.lower[c]) / experiment.grid.cell_size);
    };
    seed_body(experiment, body).for_each_batch([&](const SeedBatch& batch) {
      for (std::size_t p = 0; p < batch.count; ++p) {
        bool other = false;
        for (std::size_t c = 0; c < D; ++c)
          other |= cell(now[(batch.first + p) * D + c], c) != cell(batch.position[p * D + c], c);
        moved += other;
      }
    });
  }
  return static_cast<double>(moved) / static_cast<double>(simulation.particle_count());
}

std::string crossings(const Evidence& run) {
  constexpr double many = 0.1;
  if (run.experiment().shape.plugin->id() != "linear" || run.rows.state_lost()) return "";
  if (run.simulation.particle_changes()) return "";  // nobody knows where particles that came later began
  const double share = share_in_other_cells(run.simulation);
  if (!(share > many)) return "";
  return digits(100 * share) +
         " % of the particles ended in another cell than they began in: with the linear shape forces jump where a "
         "particle crosses into another cell, and neither smaller cells nor smaller steps help; take B-splines, GIMP "
         "or CPDI (docs/lessons/2_cell_crossing.md)";
}

std::string loneliness(const Evidence& run) {
  if (run.rows.state_lost()) return "";
  const std::size_t alone = lone_particles(run.simulation);
  if (alone == 0) return "";
  return std::to_string(alone) + " of " + std::to_string(run.simulation.particle_count()) +
         " particles ended alone: no other one lies in the reach of their shape, so that nothing of the body acts on "
         "them any more. What was drawn so far apart has come apart by the grid and not by the material; take more "
         "particles a cell, or a shape that grows with the particle, \"cpdi\" (docs/lessons/5_large_stretch.md)";
}

/// A body that is soft beside another one of its velocity field takes as many steps as that one wants. Transfers that
/// replace the particles' velocities lose some of its motion in each of them: with a hundred times the steps that it would
/// take alone, the soft bar of the study of stiff bars meets the other one by APIC as if both were rigid.
std::string soft_partner(const Evidence& run) {
  constexpr double many = 100;
  const Experiment& experiment = run.experiment();
  const Plugin& transfer = *experiment.transfer.plugin;
  if (transfer.transfer().traits & MPM_GATHERS_INCREMENT || experiment.filter || run.rows.state_lost()) return "";
  std::map<int, std::set<int>> materials;
  for (const BodySpecification& body : experiment.bodies)
    if (!body.frozen) materials[body.field].insert(body.material);
  // Of a velocity field the bodies whose speeds limit the step least and most, m/s.
  std::map<int, std::pair<double, int>> slowest, fastest;
  for (int k = 0; k < static_cast<int>(experiment.bodies.size()); ++k) {
    const BodySpecification& body = experiment.bodies[static_cast<std::size_t>(k)];
    if (body.frozen || materials[body.field].size() < 2) continue;
    const std::vector<double> waves =
        material_quantities(experiment, k, run.simulation.backend().body_state(k)).wave_speed;
    if (waves.empty()) continue;
    const std::pair<double, int> here{*std::max_element(waves.begin(), waves.end()), k};
    slowest[body.field] = std::min(slowest.try_emplace(body.field, here).first->second, here);
    fastest[body.field] = std::max(fastest.try_emplace(body.field, here).first->second, here);
  }
  for (const auto& [field, fast] : fastest) {
    const auto& slow = slowest.at(field);
    if (!(fast.first >= many * slow.first)) continue;
    const auto name = [&](int k) { return "\"" + experiment.bodies[static_cast<std::size_t>(k)].name + "\""; };
    return "body " + name(slow.second) + " shares a velocity field with " + name(fast.second) + ", which wants steps " +
           digits(fast.first / slow.first) + " times as short: transfer \"" + std::string(transfer.id()) +
           "\" damps it in each of these, so that where the two meet it does as if it were rigid; take transfer "
           "\"flip\", or "
           "\"contact\", which gives each body a field of its own (docs/studies/extremes.md#how-unlike)";
  }
  return "";
}

/// A law that scales its softening by the cells is told how many of them a crack is wide. On quadratic B-splines a crack
/// dissipates what a band of two cells does (figures/studies/damage_cells.csv), however narrow the law takes it for.
std::string narrow_band(const Evidence& run) {
  const Experiment& experiment = run.experiment();
  if (!experiment.shape.plugin->id().starts_with("bspline")) return "";
  if (!(output::number_at(run.summary, "energy.ledger.damage") > 0)) return "";  // nothing has cracked, or nobody knows
  for (const BodySpecification& body : experiment.bodies) {
    const MaterialSpecification& material = experiment.materials[static_cast<std::size_t>(body.material)];
    for (const mpm_parameter& parameter : material.component.plugin->parameters()) {
      if (body.frozen || std::string_view(parameter.name) != "band_cells") continue;
      const double band = material.component.parameter("band_cells");
      if (band >= 2) continue;
      return "material \"" + material.name + "\" softens over a band of " + digits(band) +
             " cells, and on B-splines a crack dissipates what a band of two cells does: where it has cracked it took "
             "up about " +
             digits(2 / band) +
             " times its fracture energy; set band_cells to 2, on smaller cells where that is refused, or take shape "
             "\"linear\" or \"gimp\" (docs/studies/crack_bands.md)";
    }
  }
  return "";
}

/// Contact that acted while nothing touched.
std::string early_contact(const Evidence& run) {
  constexpr double most_of_it = 0.1;
  const Seen& seen = run.rows.seen();
  const double h = run.experiment().grid.cell_size;
  if (seen.early_force > most_of_it * seen.largest_force) {
    const Plugin& detection = *run.experiment().contact_detection->plugin;
    const std::string open = "contact acted while a gap of " + digits(seen.early_gap / h) +
                             " cells was open between the bodies, with " +
                             digits(100 * seen.early_force / seen.largest_force) + " % of the largest force: ";
    if (!(detection.detection().traits & (MPM_READS_EDGES | MPM_READS_PARTICLE_SURFACES)))
      return open + "detection \"" + std::string(detection.id()) +
             "\" does not know where the surfaces are; take \"approach_and_position\" (docs/method.md#contact)";
    return open +
           "detection sees a surface where a body has no particles, as at corners, in thin parts and with few "
           "particles "
           "a cell; take smaller cells or more particles a cell (docs/method.md#contact)";
  }
  if (seen.apart_force > most_of_it * seen.largest_force)
    return "a contact force of " + digits(seen.apart_force) +
           " was recorded where detection said that nothing touches, " +
           digits(100 * seen.apart_force / seen.largest_force) +
           " % of the largest: it was given before the forces of the step, which then parted the bodies; take smaller "
           "steps where the force matters (docs/method.md#contact)";
  return "";
}

}  // namespace

std::vector<std::string> warnings_of(const Simulation& simulation, const Metrics& metrics, const RunRecord& rows,
                                     const Json& summary) {
  const Evidence run{simulation, metrics, rows, summary};
  std::vector<std::string> all;
  for (const auto warning :
       {rim_steps, coarse_contact, early_contact, sliding_block, tent_steps, crossings, loneliness, soft_partner,
        narrow_band, numerical_loss, unexplained_loss, books, images, filter_growth, few_entries})
    if (const std::string text = warning(run); !text.empty()) all.push_back(text);
  for (std::string& text : rows.clamps().warnings()) all.push_back(std::move(text));
  for (std::string& text : rows.gases().warnings()) all.push_back(std::move(text));
  if (const ParticleChanges* const changes = simulation.particle_changes())
    for (std::string& text : changes->warnings()) all.push_back(std::move(text));
  return all;
}

}  // namespace mpm::app
