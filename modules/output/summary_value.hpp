// Values out of summary.json, for what judges a run and what compares runs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace mpm::output {

using Json = nlohmann::ordered_json;

/// `outcome.status` of a run that finished and broke a limit, but no expectation.
inline constexpr const char* limit_broken = "limit broken";

/// The value at a JSON pointer ("/error/position/rms") or dotted path ("error.position.rms"); null when there is none.
const Json* value_at(const Json& summary, const std::string& path);

/// The number at a path of value_at(); NaN when there is none.
double number_at(const Json& summary, const std::string& path);

}  // namespace mpm::output
