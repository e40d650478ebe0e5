#pragma once
// The limits of /limits: energy that a scene gained out of nothing, and volume ratios out of range.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm::app {

/// Adds the groups `limits` and `flags`; returns the flags: the names of the limits that the run broke. The recorded
/// rows are judged. A limit that cannot be judged says why in `limits`.
std::vector<std::string> judge_limits(const Experiment& experiment, nlohmann::ordered_json& summary);

/// What works on the scene from outside, so that a gain of energy means nothing; "" for an isolated scene.
std::string work_from_outside(const Experiment& experiment);

}  // namespace mpm::app
