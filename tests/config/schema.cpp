// The JSON Schema says what the reader's tables say.
#include "experiment/schema.hpp"

#include <functional>

#include "config/config_support.hpp"
#include "drive/sections.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;
using Json = nlohmann::ordered_json;

namespace {

const Json& schema() {
  static const Json written = json_schema(components(), options());
  return written;
}

/// The branch of a choice for one value of "type".
const Json& branch(const std::string& definition, const std::string& type) {
  for (const Json& one : schema()["$defs"][definition]["allOf"]) {
    if (one["if"]["properties"]["type"]["const"] == type) return one["then"];
  }
  throw std::out_of_range(definition + " has no type " + type);
}

void each(const Json& value, const std::function<void(const Json&)>& visit) {
  visit(value);
  if (!value.is_structured()) return;
  for (const Json& child : value) each(child, visit);
}

/// Checks that every key of an accepted experiment is a property where the schema leads for it.
void check_keys(const Json& value, const Json& at) {
  if (at.contains("$ref")) return check_keys(value, schema()["$defs"][at["$ref"].get<std::string>().substr(8)]);
  if (at.contains("anyOf") && !at.contains("properties") && value.is_structured())
    return check_keys(value, at["anyOf"][at["anyOf"][0].contains("enum") ? 1 : 0]);
  if (value.is_array()) {
    for (const Json& item : value) check_keys(item, at["items"]);
    return;
  }
  if (!value.is_object()) return;
  if (at.contains("allOf")) {
    for (const Json& one : at["allOf"]) {
      if (one["if"]["properties"]["type"]["const"] == value["type"]) return check_keys(value, one["then"]);
    }
    FAIL("no branch for " << value["type"]);
  }
  for (const auto& [key, member] : value.items()) {
    INFO(key);
    const bool map = !at.contains("properties");
    REQUIRE((map || at["properties"].contains(key)));
    check_keys(member, map ? at["additionalProperties"] : at["properties"][key]);
  }
}

}  // namespace

TEST_CASE("the schema has every key of the experiment", "[schema]") {
  CHECK(schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema");
  CHECK(schema()["additionalProperties"] == false);
  for (const char* key :
       {"title", "dimension", "precision", "backend", "seed",      "constants", "grid",    "node_conditions",
        "shape", "transfer",  "filter",    "contact", "materials", "bodies",    "gravity", "body_force",
        "loads", "damping",   "solver",    "output",  "figures",   "compare",   "limits"}) {
    INFO(key);
    CHECK(schema()["properties"].contains(key));
  }
  CHECK(schema()["required"] == Json({"dimension", "grid", "shape", "transfer", "materials", "bodies", "solver"}));
  check_keys(read_text(two_discs).resolved, schema());
}

TEST_CASE("the solver of a file says whether its keys are those of an experiment or of a material point", "[schema]") {
  const Json both =
      json_schema(components(), options(),
                  {{drive::drive_section(), drive::solver_section(), {{"stages", drive::stage_section(3)}}}});
  const Json &solver = both["if"]["properties"]["solver"], &point = both["then"];
  CHECK(both["if"]["required"] == Json({"solver"}));
  CHECK(solver["properties"]["type"]["const"] == "material_point");
  CHECK(solver["required"] == Json({"type"}));
  for (const char* key : {"properties", "required", "additionalProperties"}) CHECK(both["else"][key] == schema()[key]);
  CHECK(point["required"] == Json({"materials", "solver"}));
  CHECK(point["additionalProperties"] == false);
  CHECK(!point["properties"].contains("bodies"));
  const Json& keys = point["properties"]["solver"]["properties"];
  CHECK(keys["type"]["const"] == "material_point");
  CHECK(keys["stages"]["$ref"] == "#/$defs/stages");
  const Json& stages = both["$defs"]["stages"];
  CHECK(stages["type"] == "array");
  for (const char* key : {"name", "duration", "steps", "deformation_gradient", "velocity_gradient", "stress"})
    CHECK(stages["items"]["properties"].contains(key));
  CHECK(stages["items"]["additionalProperties"] == false);
}

TEST_CASE("parameters of plugins appear with unit, range, default and choices", "[schema]") {
  const Json& material = branch("material", "neo_hookean");
  CHECK(material["required"] == Json({"type", "density", "youngs_modulus"}));
  CHECK(material["additionalProperties"] == false);
  CHECK(material["properties"]["density"]["description"] == "A number. Unit: kg/m^3.");
  CHECK(material["properties"]["density"]["anyOf"][0]["exclusiveMinimum"] == 0);
  CHECK(material["properties"]["density"]["anyOf"][1]["type"] == "string");
  CHECK(material["properties"]["poisson_ratio"]["default"] == 0.3);
  CHECK(material["properties"]["form"]["enum"] == Json({"standard", "logarithmic"}));
  CHECK(material["properties"]["form"]["default"] == "logarithmic");
  CHECK(branch("transfer", "slow_double")["properties"]["quadratic"]["default"] == true);
  CHECK(branch("contact", "coulomb")["properties"].contains("detection"));
  CHECK(schema()["$defs"]["shape"]["properties"]["type"]["enum"] == Json({"linear", "bspline_quadratic", "only_flat"}));
  CHECK(schema()["$defs"]["filter"].contains("not"));
  CHECK(schema()["properties"]["figures"]["items"]["anyOf"][0]["enum"] == Json({"energy", "dissipation", "contact"}));
}

TEST_CASE("a key that may be null says so, with its default", "[schema]") {
  const Json& limits = schema()["$defs"]["limits"]["properties"];
  CHECK(limits["energy_gain"]["anyOf"][1]["type"] == "null");
  CHECK(limits["energy_gain"]["default"] == 0.01);
  CHECK(limits["volume_ratio"]["anyOf"][0]["minItems"] == 2);
  CHECK(limits["volume_ratio"]["default"] == Json({0.1, 10.0}));
  CHECK(limits["isolated"]["type"] == "boolean");
}

TEST_CASE("a choice that may be true or false says so, with its default", "[schema][film]") {
  const Json& film = schema()["$defs"]["output"]["properties"]["film"];
  CHECK(film["anyOf"][0]["type"] == "boolean");
  CHECK(film["anyOf"][1]["enum"] == Json({"mp4", "webm", "webp"}));
  CHECK(film["default"] == false);
}

TEST_CASE("every reference in the schema leads somewhere", "[schema]") {
  each(schema(), [](const Json& value) {
    if (!value.is_object() || !value.contains("$ref")) return;
    const std::string name = value["$ref"].get<std::string>().substr(8);
    INFO(name);
    CHECK(schema()["$defs"].contains(name));
  });
}
