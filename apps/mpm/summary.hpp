#pragma once
// summary.json: the last values of a run, what held and what did not.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mpm/recorder.hpp"

namespace mpm::app {

/// How a run ended.
struct Outcome {
  int exit_code = 0;
  std::string status = "done";  ///< done, failed, expectation failed, interrupted
  std::string reason;
};

/// All groups but `expect` and `outcome`.
nlohmann::ordered_json summarise(const Simulation& simulation, const Metrics& metrics, const Recorder& recorder,
                                 double wall_seconds);

/// Adds the group `expect`; returns the sentences of those that do not hold. A metric that summary.json does not have
/// counts as not held, with the names it has.
std::vector<std::string> judge_expectations(const Experiment& experiment, nlohmann::ordered_json& summary);

}  // namespace mpm::app
