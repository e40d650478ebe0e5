#include "run/limits.hpp"

#include <cmath>

#include "experiment/diagnostics.hpp"
#include "output/summary_value.hpp"
#include "support/numbers.hpp"

namespace mpm::app {
namespace {

using Json = nlohmann::ordered_json;

/// A bound on a number of the summary: "at_least" or "at_most".
struct Limit {
  const char *metric, *kind;
  std::optional<double> bound;  ///< bound; nothing: the file asks for none
  std::string not_judged;       ///< why it is not judged, where it cannot be
};

/// Fills the entry of `limits` and returns whether the number keeps its bound. One that is not finite keeps none.
bool judge(const Limit& limit, const Json& summary, Json& entry) {
  const double value = output::number_at(summary, limit.metric);
  entry = {{"metric", limit.metric}};
  if (limit.bound) entry[limit.kind] = *limit.bound;
  entry["value"] = std::isfinite(value) ? Json(value) : Json(nullptr);
  const std::string reason = limit.bound ? limit.not_judged : "no limit is asked for";
  if (!reason.empty()) {
    entry["not_judged"] = reason;
    return true;
  }
  const bool held = std::string(limit.kind) == "at_least" ? value >= *limit.bound : value <= *limit.bound;
  entry["held"] = held;
  return held;
}

std::string why_no_loss_is_judged(const Experiment& experiment, const Json& summary) {
  const std::string reason = why_no_change_is_judged(experiment, summary);
  if (!reason.empty()) return reason;
  if (!experiment.output.ledger) return "not recorded: /output/ledger is false";
  return output::value_at(summary, "energy.total.unexplained_loss") ? "" : "not recorded: the last step failed";
}

std::string per_cent(double share) {
  return number_text(100 * share) + " %";
}

}  // namespace

std::string why_no_change_is_judged(const Experiment& experiment, const Json& summary) {
  if (const auto isolated = experiment.limits.isolated; isolated && !*isolated) return "/limits/isolated is false";
  const std::string work = experiment.limits.isolated ? "" : work_from_outside(experiment);
  if (!work.empty()) return work;
  return output::value_at(summary, "energy.total.gain") ? "" : "not recorded: the scene begins without energy";
}

double numerical_gain(const Ledger& ledger) {
  return ledger.scatter + ledger.gather + ledger.boundary + (ledger.contact + ledger.friction + ledger.interface) +
         ledger.filter + ledger.filtered_strain + ledger.filtered_gravity + ledger.remapped_strain +
         ledger.second_moment;
}

std::string work_from_outside(const Experiment& experiment) {
  if (experiment.body_force) return experiment.body_force_pointer + " works on the scene";
  if (experiment.changing_gravity) return "/gravity works on the scene: it changes in time";
  if (!experiment.loads.empty()) return experiment.loads.front().pointer + " works on the scene";
  for (int axis = 0; axis < experiment.dimension; ++axis)
    for (const FaceCondition& face : experiment.faces[axis]) {
      if (face.velocity) return face.pointer + " works on the scene: the wall moves";
      // A particle that comes in again at the other side has its height again.
      if (face.type == ConditionType::periodic && experiment.gravity[axis] != 0)
        return "/gravity works on the scene: it points along a periodic direction";
    }
  for (const BoxCondition& box : experiment.boxes)
    if (box.velocity) return box.pointer + " works on the scene: its nodes are moved";
  if (!experiment.grips.empty())
    return experiment.grips.front().pointer + " works on the scene: its particles are moved";
  if (const std::string changer = experiment.changer_of_particles(); !changer.empty())
    return changer + " works on the scene: it changes which particles there are";
  for (const RigidBodySpecification& body : experiment.rigid_bodies)
    if (body.moves()) return body.pointer + " works on the scene: it moves as it is told";
  return "";
}

std::vector<std::string> judge_limits(const Experiment& experiment, Json& summary) {
  const Limits& limits = experiment.limits;
  const auto ratio = [&](int end) {
    return limits.volume_ratio ? std::optional<double>((*limits.volume_ratio)[end]) : std::nullopt;
  };
  const Limit gain{"energy.total.gain", "at_most", limits.energy_gain, why_no_change_is_judged(experiment, summary)};
  const std::string no_loss = why_no_loss_is_judged(experiment, summary);
  const Limit losses[] = {{"energy.total.numerical_loss", "at_most", limits.numerical_loss, no_loss},
                          {"energy.total.unexplained_loss", "at_most", limits.unexplained_loss, no_loss}};
  const Limit smallest{"stability.smallest_volume_ratio", "at_least", ratio(0), ""};
  const Limit largest{"stability.largest_volume_ratio", "at_most", ratio(1), ""};
  std::vector<std::string> flags;
  const auto number = [&](const Limit& limit) { return output::number_at(summary, limit.metric); };
  Json entries = Json::array();
  if (!judge(gain, summary, entries.emplace_back()))
    flags.push_back("energy gain of " + support::three_digits(100 * number(gain)) + " % (limit " +
                    number_text(100 * *gain.bound) + " %)");
  if (!judge(smallest, summary, entries.emplace_back()))
    flags.push_back("smallest volume ratio J " + support::three_digits(number(smallest)) + " (limit " +
                    number_text(*smallest.bound) + ")");
  if (!judge(largest, summary, entries.emplace_back()))
    flags.push_back("largest volume ratio J " + support::three_digits(number(largest)) + " (limit " +
                    number_text(*largest.bound) + ")");
  for (const auto& [limit, name] : {std::pair{&losses[0], "numerical"}, std::pair{&losses[1], "unexplained"}})
    if (!judge(*limit, summary, entries.emplace_back()))
      flags.push_back(std::string(name) + " loss of " + support::three_digits(100 * number(*limit)) +
                      " % of the energy (limit " + per_cent(*limit->bound) + ")");
  summary["limits"] = std::move(entries);
  summary["flags"] = flags;
  return flags;
}

}  // namespace mpm::app
