#pragma once
// summary.json: the last values of a run, what held and what did not.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run/run_record.hpp"
#include "simulation/imposed_value.hpp"

namespace mpm::app {

/// How a run ended.
struct Outcome {
  int exit_code = 0;
  std::string status = "done";  ///< done, failed, expectation failed, limit broken, interrupted
  std::string reason;
  nlohmann::ordered_json failure = nlohmann::ordered_json::object();  ///< record_of what stopped it, if that was one
};

/// What summary.json has beside the reason of a run that a particle stopped: {"cause", "where": {step, time, body,
/// particle, position}, "values": [{name, unit, value}], "remedy"}.
nlohmann::ordered_json record_of(const Failure& failure, const FailurePlace& place, const Experiment& experiment);
/// The same where a wall or a box imposed what nothing can have: "where" has the condition in place of the particle.
nlohmann::ordered_json record_of(const ImposedValue& imposed, long step);

/// What a resumed run spent before: only the work that led to the result, not what was lost with a process that was
/// killed.
struct EarlierParts {
  double wall_seconds = 0;
  std::map<std::string, double> seconds_by_pass;
  std::vector<long> resumed_from_steps;  ///< step of each resumption, the last one included
};

/// Makes all groups but `expect`, `limits`, `flags` and `outcome`. `wall_seconds` is that of this process.
nlohmann::ordered_json summarise(const Simulation& simulation, const Metrics& metrics, const RunRecord& recorder,
                                 double wall_seconds, const EarlierParts& earlier);

/// Adds the group `expect`; returns the sentences of those that do not hold. A metric that summary.json does not have
/// counts as not held, with the names it has.
std::vector<std::string> judge_expectations(const Experiment& experiment, nlohmann::ordered_json& summary);

}  // namespace mpm::app
