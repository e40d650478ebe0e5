#pragma once
// The limits of /limits: energy that a scene gained out of nothing, and volume ratios out of range.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "simulation/backend.hpp"

namespace mpm::app {

/// Adds the groups `limits` and `flags`; returns the flags: the names of the limits that the run broke. The recorded
/// rows are judged. A limit that cannot be judged says why in `limits`.
std::vector<std::string> judge_limits(const Experiment& experiment, nlohmann::ordered_json& summary);

/// Why neither gains nor losses of energy mean anything; "" where they are judged.
std::string why_no_change_is_judged(const Experiment& experiment, const nlohmann::ordered_json& summary);

/// The energy that transfers, filters, walls that hold still and contact gave without a physical cause, J: of FLIP, whose
/// rows undo each other, only their sum means something.
double numerical_gain(const Ledger& ledger);

/// What works on the scene from outside, so that a gain of energy means nothing; "" for an isolated scene.
std::string work_from_outside(const Experiment& experiment);

}  // namespace mpm::app
