// docs/experiment_file.md prints the default of each key: those that are values are the ones that the schema has.

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
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.exact = exact_solutions();
  std::map<std::string, std::set<std::string>> defaults;
  gather_defaults(json_schema(plugins(), options), defaults);

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
