#pragma once
// What a run's summary.json says to a study: measures, bounds, flags.

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/study.hpp"

namespace mpm::study {

using Json = nlohmann::ordered_json;

inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// The measure's value of a run of this combination, its formula applied; NaN when the summary lacks it.
double evaluate(const Study& study, const Measure& measure, const Combination& combination, const Json& summary);

/// Whether every bound holds; `broken` gets a sentence for each that does not.
bool all_hold(const std::vector<Bound>& bounds, const Json& summary, std::vector<std::string>& broken);

/// Names of the limits that the run broke: "energy gain of 3.2 % (limit 1 %)". Empty when it respected all.
std::vector<std::string> flags_in(const Json& summary);

}  // namespace mpm::study
