// docs/experiment_file.md prints the default of each key and the range of many: they are those that the schema has.

#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "experiment/schema.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;
using Json = nlohmann::ordered_json;

namespace {

/// Defaults by key, whatever object the key stands in: a key of several objects has those of all.
void gather_defaults(const Json& at, std::map<std::string, std::set<std::string>>& defaults) {
  if (!at.is_structured()) return;
  if (at.is_object() && at.contains("properties"))
    for (const auto& [key, property] : at["properties"].items())
      if (property.is_object() && property.contains("default")) defaults[key].insert(property["default"].dump());
  for (const Json& child : at) gather_defaults(child, defaults);
}

/// The schema's least and largest values by key, in the same way; "exclusiveMinimum" and the like count as those.
void gather_bounds(const Json& at, std::map<std::string, std::set<std::pair<double, double>>>& bounds) {
  if (!at.is_structured()) return;
  if (at.is_object() && at.contains("properties"))
    for (const auto& [key, property] : at["properties"].items()) {
      std::pair<double, double> range{-1e300, 1e300};
      const auto narrow = [&](const Json& one) {
        for (const auto& [name, value] : one.items()) {
          if (name == "minimum" || name == "exclusiveMinimum") range.first = value.get<double>();
          if (name == "maximum" || name == "exclusiveMaximum") range.second = value.get<double>();
        }
      };
      if (!property.is_object()) continue;
      narrow(property);
      for (const char* either : {"anyOf", "oneOf"})
        if (property.contains(either))
          for (const Json& one : property[either])
            if (one.is_object()) narrow(one);
      bounds[key].insert(range);
    }
  for (const Json& child : at) gather_bounds(child, bounds);
}

Json schema_of_experiments() {
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.exact = exact_solutions();
  return json_schema(plugins(), options);
}

/// As JSON writes it, numbers all as doubles.
std::string as_value(const Json& value) {
  if (value.is_number()) return Json(value.get<double>()).dump();
  if (!value.is_array()) return value.dump();
  std::string items;
  for (const Json& item : value) items += as_value(item) + ' ';
  return items;
}

}  // namespace

TEST_CASE("the defaults on the page of the experiment file are those of the schema", "[docs]") {
  std::map<std::string, std::set<std::string>> defaults;
  gather_defaults(schema_of_experiments(), defaults);

  std::istringstream page(support::read_file(MPM_SOURCE_DIR "/docs/experiment_file.md"));
  const std::regex row(R"re(\| ((?:`[a-z_]+`(?:, )?)+) \| (`?)([^`|]+)`? \|.*)re"), name("`([a-z_]+)`");
  std::smatch match;
  int compared = 0;
  bool of_defaults = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| key")) of_defaults = line.find("| default |") != std::string::npos;
    if (!of_defaults || !std::regex_match(line, match, row)) continue;
    const Json printed = Json::parse(match[3].str(), nullptr, false);
    if (printed.is_discarded() || printed.is_null()) continue;  // a word such as "none", or no default at all
    const std::string keys = match[1];
    for (std::sregex_iterator key(keys.begin(), keys.end(), name), end; key != end; ++key) {
      const auto known = defaults.find((*key)[1]);
      if (known == defaults.end()) continue;  // none that the schema could give: it follows from something else
      std::set<std::string> values;
      for (const std::string& value : known->second) values.insert(as_value(Json::parse(value)));
      INFO(line);
      CHECK(values.count(as_value(printed)) == 1);
      ++compared;
    }
  }
  CHECK(compared > 35);
}

TEST_CASE("the ranges on the page of the experiment file are those of the schema", "[docs]") {
  std::map<std::string, std::set<std::pair<double, double>>> bounds;
  gather_bounds(schema_of_experiments(), bounds);
  std::istringstream page(support::read_file(MPM_SOURCE_DIR "/docs/experiment_file.md"));
  const std::regex row(R"re(\| `([a-z_]+)` \| [^|]* \| ([^|]*).*)re"),
      range("([0-9.]+) to (?:below )?([0-9.]+)[:, ].*|(?:above|at least) ([0-9.]+), (?:at most|below) ([0-9.]+): .*");
  std::smatch match, found;
  int compared = 0;
  for (std::string line; std::getline(page, line);) {
    if (!std::regex_match(line, match, row)) continue;
    const auto known = bounds.find(match[1]);
    // The range stands first, or behind what the key is: "C₁, 0 to 100".
    const std::string meaning = std::regex_replace(match[2].str(), std::regex("^[^0-9,]{1,20}[₁₂]?, "), "");
    if (known == bounds.end() || !std::regex_match(meaning, found, range)) continue;
    const int from = found[1].matched ? 1 : 3;
    INFO(line);
    CHECK(known->second.count({std::stod(found[from]), std::stod(found[from + 1])}) == 1);
    ++compared;
  }
  CHECK(compared >= 7);
}

TEST_CASE("the defaults that the page of the experiment file has in brackets are those of the schema", "[docs]") {
  const Json schema = schema_of_experiments();
  std::map<std::string, std::set<std::string>> defaults;
  std::map<std::string, std::set<std::pair<double, double>>> bounds;
  gather_defaults(schema, defaults), gather_bounds(schema, bounds);
  const std::string page = support::read_file(MPM_SOURCE_DIR "/docs/experiment_file.md");
  const std::regex in_brackets("`([a-z_]+)`(?: points| times| at t = 0)? \\(([0-9.]+)(?: rad|, up to ([0-9.]+))?[;)]");
  int compared = 0;
  for (std::sregex_iterator match(page.begin(), page.end(), in_brackets), end; match != end; ++match) {
    const auto known = defaults.find((*match)[1]);
    if (known == defaults.end()) continue;
    INFO(match->str());
    bool same = false;
    for (const std::string& text : known->second)
      if (const Json value = Json::parse(text); value.is_number())
        same = same || value.get<double>() == std::stod((*match)[2]);
    CHECK(same);
    ++compared;
    if (!(*match)[3].matched) continue;
    bool most = false;
    for (const auto& [low, high] : bounds[(*match)[1]]) most = most || high == std::stod((*match)[3]);
    CHECK(most);
  }
  CHECK(compared >= 8);
}
