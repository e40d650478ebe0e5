#include "output/json_differences.hpp"

#include <algorithm>

namespace mpm::output {
namespace {

using Json = nlohmann::ordered_json;

std::string escaped(const std::string& key) {
  std::string text;
  for (const char c : key) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return text;
}

void collect(const Json* first, const Json* second, const std::string& pointer, std::vector<JsonDifference>& found) {
  const bool both_objects = first && second && first->is_object() && second->is_object();
  const bool both_arrays = first && second && first->is_array() && second->is_array();
  if (both_objects) {
    for (const auto& [key, value] : first->items())
      collect(&value, second->contains(key) ? &(*second)[key] : nullptr, pointer + "/" + escaped(key), found);
    for (const auto& [key, value] : second->items())
      if (!first->contains(key)) collect(nullptr, &value, pointer + "/" + escaped(key), found);
  } else if (both_arrays) {
    for (std::size_t k = 0; k < std::max(first->size(), second->size()); ++k)
      collect(k < first->size() ? &(*first)[k] : nullptr, k < second->size() ? &(*second)[k] : nullptr,
              pointer + "/" + std::to_string(k), found);
  } else if (!first || !second || *first != *second) {
    found.push_back({pointer, first, second});
  }
}

}  // namespace

std::vector<JsonDifference> differences(const Json& first, const Json& second) {
  std::vector<JsonDifference> found;
  collect(&first, &second, "", found);
  return found;
}

std::string short_text(const Json* value) {
  if (!value) return "not there";
  const std::string text = value->dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() > 80 ? text.substr(0, 77) + "..." : text;
}

}  // namespace mpm::output
