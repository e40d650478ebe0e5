// Where two JSON values differ.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mpm::output {

/// One place at which two values differ; it points into them.
struct JsonDifference {
  std::string pointer;                           ///< JSON pointer, "" for the root
  const nlohmann::ordered_json *first, *second;  ///< null where there is no value
};

/// Every place at which two values differ, in the order of the first; what only the second has comes after what both
/// have. Objects and lists are entered; a list that is longer differs at the places that the other lacks. Both values
/// must outlive the result.
std::vector<JsonDifference> differences(const nlohmann::ordered_json& first, const nlohmann::ordered_json& second);

/// The value in at most 80 characters; "not there" for null pointers.
std::string short_text(const nlohmann::ordered_json* value);

}  // namespace mpm::output
