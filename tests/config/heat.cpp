// What files say of heat: what good ones become, and whole error texts of bad ones.
#include "config/config_support.hpp"
#include "experiment/schema.hpp"
#include "experiment/thermal.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* const pond = R"json({
  "dimension": 2,
  "constants": {"warm": 283.15},
  "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {
    "all": {"type": "slip", "temperature": "warm"},
    "x_min": {"type": "prescribed", "velocity": [0, 0], "temperature": "warm - 10*min(t, 2)"},
    "x_max": {"type": "stick", "heat_flux": "-2 kW/m^2"},
    "y_min": {"type": "stick", "convection": {"coefficient": "25 W/(m^2 K)", "temperature": "263.15 + x"}},
    "y_max": "slip"}},
  "node_conditions": [
    {"type": "stick", "lower": [0, 0], "upper": [1, 0], "temperature": "250 K"},
    {"type": "thermal", "lower": [0, 1], "upper": [1, 1], "heating": "5*t"}
  ],
  "shape": {"type": "linear"}, "transfer": {"type": "apic"},
  "materials": {
    "ice": {"type": "neo_hookean", "density": 917, "youngs_modulus": "1 MPa", "poisson_ratio": 0.2, "thermal": {
      "conductivity": "2.22 W/(m K)", "heat_capacity": "2.09 kJ/(kg K)", "dissipation_to_heat": 0.9,
      "phase_change": {"temperature": 273.15, "latent_heat": "334 kJ/kg",
        "melted": {"conductivity": 0.556, "youngs_modulus": 10, "form": "standard"}}}},
    "rock": {"type": "linear_elastic", "density": 2600, "youngs_modulus": 1e6,
      "thermal": {"conductivity": 3, "heat_capacity": 800}}
  },
  "bodies": [
    {"name": "block", "material": "ice", "temperature": "260 + 5*y",
     "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 0.5]}},
    {"name": "lid", "material": "rock", "temperature": "280 K",
     "geometry": {"type": "box", "lower": [0, 0.5], "upper": [1, 1]}}
  ],
  "solver": {"end_time": 1}
})json";

std::string pond_errors(std::string_view from, std::string_view to) {
  const std::string changed = replaced(pond, from, to);
  return changed == pond ? "nothing was replaced" : errors(changed);
}

}  // namespace

TEST_CASE("what a file says of heat is read as written", "[config]") {
  const Experiment e = read_text(pond);
  CHECK(e.has_temperature());
  CHECK_FALSE(read_text(two_discs).has_temperature());

  REQUIRE(e.materials[0].thermal);
  const Thermal& ice = *e.materials[0].thermal;
  CHECK(ice.solid.conductivity == 2.22);
  CHECK(ice.solid.heat_capacity == 2090);
  CHECK(ice.dissipation_to_heat == 0.9);
  CHECK(ice.pointer == "/materials/ice/thermal");
  REQUIRE(ice.phase_change);
  const PhaseChange& change = *ice.phase_change;
  CHECK(change.temperature == 273.15);
  CHECK(change.latent_heat == 334000);
  CHECK(change.melted.conductivity == 0.556);
  CHECK(change.melted.heat_capacity == 2090);
  CHECK(e.materials[0].component.parameters == std::vector<double>{917, 1e6, 0.2, 1});
  CHECK(change.melted_parameters == std::vector<double>{917, 10, 0.2, 0});
  CHECK(change.pointer == "/materials/ice/thermal/phase_change");
  REQUIRE(e.materials[1].thermal);
  CHECK(e.materials[1].thermal->dissipation_to_heat == 0);
  CHECK_FALSE(e.materials[1].thermal->phase_change);

  CHECK((*e.bodies[0].temperature)({0, 0.4, 0}, {0, 0.4, 0}, 0) == 262);
  CHECK((*e.bodies[1].temperature)({}, {}, 0) == 280);

  const ThermalCondition& cooled = e.faces[0][0].thermal;
  CHECK(cooled.exchange == HeatExchange::fixed_temperature);
  CHECK(cooled.value({}, {}, 1) == 273.15);
  CHECK(cooled.value.uses_time());
  CHECK(cooled.pointer == "/grid/boundaries/x_min/temperature");
  CHECK(e.faces[0][0].type == ConditionType::prescribed);
  CHECK(e.faces[0][1].thermal.exchange == HeatExchange::flux);
  CHECK(e.faces[0][1].thermal.value({}, {}, 0) == -2000);
  CHECK(e.faces[1][0].thermal.exchange == HeatExchange::convection);
  CHECK(e.faces[1][0].thermal.coefficient == 25);
  CHECK(e.faces[1][0].thermal.value({2, 0, 0}, {}, 0) == 265.15);
  CHECK(e.faces[1][1].thermal.exchange == HeatExchange::none);
  CHECK(e.faces[2][0].thermal.exchange == HeatExchange::none);

  CHECK(e.boxes[0].thermal.exchange == HeatExchange::fixed_temperature);
  CHECK(e.boxes[0].thermal.value({}, {}, 0) == 250);
  CHECK(e.boxes[1].type == ConditionType::free);
  CHECK(e.boxes[1].thermal.exchange == HeatExchange::heating);
  CHECK(e.boxes[1].thermal.value({}, {}, 3) == 15);
}

TEST_CASE("\"all\" gives its temperature to the faces that are not named", "[config]") {
  const Experiment e = read_text(replaced(pond, ",\n    \"y_max\": \"slip\"", ""));
  CHECK(e.faces[1][1].thermal.exchange == HeatExchange::fixed_temperature);
  CHECK(e.faces[1][1].thermal.value({}, {}, 0) == 283.15);
  CHECK(e.faces[1][0].thermal.exchange == HeatExchange::convection);
}

TEST_CASE("the resolved file reads back as the same one, with the melted values filled", "[config]") {
  const Experiment e = read_text(pond);
  const auto& resolved = e.resolved;
  CHECK(resolved["materials"]["ice"]["thermal"]["phase_change"]["melted"] ==
        nlohmann::ordered_json({{"conductivity", 0.556},
                                {"heat_capacity", 2090.0},
                                {"youngs_modulus", 10.0},
                                {"poisson_ratio", 0.2},
                                {"form", "standard"}}));
  CHECK(resolved["materials"]["rock"]["thermal"].dump() ==
        R"({"conductivity":3.0,"heat_capacity":800.0,"dissipation_to_heat":0.0})");
  CHECK(resolved["grid"]["boundaries"]["y_max"] == "slip");
  CHECK(resolved["grid"]["boundaries"]["x_max"].dump() == R"({"type":"stick","heat_flux":-2000.0})");
  CHECK(resolved["node_conditions"][1]["type"] == "thermal");
  CHECK(resolved["bodies"][1]["temperature"] == 280);
  const Experiment again = read_text(resolved.dump());
  CHECK(again.resolved == resolved);
  CHECK(again.materials[0].thermal->phase_change->melted_parameters ==
        e.materials[0].thermal->phase_change->melted_parameters);
  CHECK(again.faces[1][0].thermal.coefficient == 25);
  CHECK_FALSE(read_text(two_discs).resolved.dump().find("thermal") != std::string::npos);
}

TEST_CASE("materials that conduct need their numbers", "[config]") {
  CHECK(pond_errors("\"conductivity\": 3, \"heat_capacity\": 800", "\"conductivity\": \"3 W/m\"") ==
        "FILE:21:18: /materials/rock/thermal/heat_capacity: missing key; expected a specific heat capacity "
        "(J/(kg K)) above 0\n"
        "FILE:21:35: /materials/rock/thermal/conductivity: expected a thermal conductivity (W/(m K)), got a quantity "
        "(W/m)");
  CHECK(pond_errors("\"conductivity\": 3,", "\"conductivity\": 0,") ==
        "FILE:21:35: /materials/rock/thermal/conductivity: out of range: expected a thermal conductivity (W/(m K)) "
        "above 0, got 0");
  CHECK(pond_errors("\"dissipation_to_heat\": 0.9", "\"dissipation_to_heat\": 90") ==
        "FILE:17:97: /materials/ice/thermal/dissipation_to_heat: out of range: expected a number from 0 to 1, got 90");
  CHECK(pond_errors("\"latent_heat\": \"334 kJ/kg\"", "\"latent_heat\": \"334 kJ\"") ==
        "FILE:18:62: /materials/ice/thermal/phase_change/latent_heat: expected an energy per mass (J/kg), got an "
        "energy (kJ)");
  CHECK(pond_errors("\"melted\": {", "\"melted\": {\"density\": 1000, ") ==
        "FILE:19:31: /materials/ice/thermal/phase_change/melted/density: a particle keeps its mass and its volume when "
        "it melts, and so its density; remove \"density\"");
  CHECK(pond_errors("\"youngs_modulus\": 10,", "\"young_modulus\": 10,") ==
        "FILE:19:43: /materials/ice/thermal/phase_change/melted/young_modulus: unknown key \"young_modulus\"; did you "
        "mean \"youngs_modulus\"? (valid keys: \"conductivity\", \"heat_capacity\", \"youngs_modulus\", "
        "\"poisson_ratio\", \"form\")");
  CHECK(pond_errors("\"melted\": {", "\"melted\": {\"density\": 1000, \"foo\": 1, ") ==
        "FILE:19:31: /materials/ice/thermal/phase_change/melted/density: a particle keeps its mass and its volume when "
        "it melts, and so its density; remove \"density\"\n"
        "FILE:19:37: /materials/ice/thermal/phase_change/melted/foo: unknown key \"foo\"; valid keys: "
        "\"conductivity\", \"heat_capacity\", \"youngs_modulus\", \"poisson_ratio\", \"form\"");
  CHECK(
      pond_errors("\"youngs_modulus\": 10,", "\"poisson_ratio\": 0.5,") ==
      "FILE:19:60: /materials/ice/thermal/phase_change/melted/poisson_ratio: out of range: expected a number above -1 "
      "and below 0.5, got 0.5");
}

TEST_CASE("all bodies have a temperature or none", "[config]") {
  CHECK(pond_errors(",\n      \"thermal\": {\"conductivity\": 3, \"heat_capacity\": 800}", "") ==
        "FILE:25:33: /bodies/1/material: material \"rock\" has no \"thermal\", which another has: all bodies have a "
        "temperature or none; give it \"thermal\": {\"conductivity\": …, \"heat_capacity\": …}");
  CHECK(pond_errors(", \"temperature\": \"280 K\"", "") ==
        "FILE:26:5: /bodies/1/temperature: missing key; expected a temperature (K) of at least 0 or an expression, as "
        "material \"rock\" has \"thermal\"");
  CHECK(pond_errors("\"280 K\"", "\"280*t\"") ==
        "FILE:26:56: /bodies/1/temperature: in the expression \"280*t\" at character 5: \"t\" is not available here; "
        "variables are x y");
  CHECK(pond_errors("\"280 K\"", "-10") ==
        "FILE:26:56: /bodies/1/temperature: out of range: expected a temperature (K) of at least 0 or an expression, "
        "got -10");
}

TEST_CASE("heat in a scene whose materials do not conduct is refused in every place", "[config]") {
  const std::string reason =
      "nothing has a temperature here, as no material has \"thermal\"; give every material \"thermal\": "
      "{\"conductivity\": …, \"heat_capacity\": …}, or remove this";
  std::string expected;
  for (const char* place :
       {"6:72: /grid/boundaries/x_min/temperature", "7:45: /grid/boundaries/x_max/heat_flux",
        "8:46: /grid/boundaries/y_min/convection", "11:72: /node_conditions/0/temperature",
        "12:70: /node_conditions/1/heating", "24:57: /bodies/0/temperature", "26:56: /bodies/1/temperature"})
    expected += (expected.empty() ? "FILE:" : "\nFILE:") + std::string(place) + ": " + reason;
  CHECK(errors(pond, {"/materials/ice/thermal=null", "/materials/rock/thermal=null"}) == expected);
  const std::string walls = errors_after("\"all\": \"slip\"", R"("all": {"type": "slip", "temperature": 300})");
  CHECK(walls == "FILE:9:59: /grid/boundaries/all/temperature: " + reason);
}

TEST_CASE("walls and boxes do one thing with heat", "[config]") {
  CHECK(pond_errors("\"heat_flux\": \"-2 kW/m^2\"", "\"heat_flux\": \"-2 kW/m^2\", \"temperature\": 300") ==
        "FILE:7:45: /grid/boundaries/x_max/heat_flux: \"heat_flux\" and \"temperature\" are not both possible in one "
        "place; remove one of them");
  CHECK(pond_errors("\"heating\": \"5*t\"", "\"heating\": \"5*t\", \"temperature\": 300") ==
        "FILE:12:70: /node_conditions/1/heating: \"heating\" and \"temperature\" are not both possible in one place; "
        "remove one of them");
  CHECK(pond_errors(", \"heating\": \"5*t\"", "") ==
        "FILE:12:5: /node_conditions/1: does nothing: give \"temperature\" or \"heating\"");
  CHECK(pond_errors("\"coefficient\": \"25 W/(m^2 K)\", ", "") ==
        "FILE:8:46: /grid/boundaries/y_min/convection/coefficient: missing key; expected a heat transfer coefficient "
        "(W/(m^2 K)) above 0");
  CHECK(pond_errors("25 W/(m^2 K)", "25 W/m^2") ==
        "FILE:8:62: /grid/boundaries/y_min/convection/coefficient: expected a heat transfer coefficient (W/(m^2 K)), "
        "got a heat flux (W/m^2)");
  CHECK(pond_errors("\"-2 kW/m^2\"", "\"-2 kW\"") ==
        "FILE:7:45: /grid/boundaries/x_max/heat_flux: expected a heat flux (W/m^2), got a power (kW)");
  CHECK(pond_errors("\"y_max\": \"slip\"", R"("y_max": {"type": "separate", "temperature": 300})") ==
        "FILE:9:50: /grid/boundaries/y_max/temperature: a wall of type \"separate\" mirrors a body only while that "
        "presses on it, and heat that comes through a wall needs the mirror image all the time; choose \"slip\" or "
        "\"stick\"");
  CHECK(pond_errors("\"y_max\": \"slip\"", R"("y_max": {"type": "free", "temperature": 300})") ==
        "FILE:9:31: /grid/boundaries/y_max/temperature: unknown key \"temperature\"; valid keys: \"type\"");
}

TEST_CASE("what does not carry or keep a temperature is refused by name", "[config][temperature]") {
  CHECK(pond_errors("\"solver\": {", "\"solver\": {\"stress_update\": \"averaged\", ") ==
        "FILE:29:31: /solver/stress_update: order \"averaged\" strains before the gather, which may replace the "
        "temperature that \"dissipation_to_heat\" of material \"ice\" has raised; choose \"last\" or "
        "\"modified_last\"");
  CHECK(pond_errors("\"solver\": {", "\"solver\": {\"stress_update\": \"first\", ") != "accepted");
  CHECK(pond_errors("\"solver\": {", "\"solver\": {\"stress_update\": \"modified_last\", ") == "accepted");
  const std::string lossless = replaced(pond, "\"dissipation_to_heat\": 0.9", "\"dissipation_to_heat\": 0");
  CHECK(errors(replaced(lossless, "\"solver\": {", "\"solver\": {\"stress_update\": \"first\", ")) == "accepted");
}

TEST_CASE("the schema has the keys of heat", "[schema]") {
  const auto schema = json_schema(components(), options());
  const auto& definitions = schema["$defs"];
  const auto& slip = definitions["face_condition"]["anyOf"];
  CHECK(slip[0]["enum"] == nlohmann::ordered_json({"slip", "stick", "separate", "free", "periodic"}));
  const auto& material = definitions["material"]["allOf"][0]["then"]["properties"];
  const auto& thermal = material["thermal"]["anyOf"][0];
  CHECK(thermal["required"] == nlohmann::ordered_json({"conductivity", "heat_capacity"}));
  const auto& melted = thermal["properties"]["phase_change"]["anyOf"][0]["properties"]["melted"]["anyOf"][0];
  CHECK(melted["properties"].contains("youngs_modulus"));
  CHECK_FALSE(melted["properties"].contains("density"));
  CHECK_FALSE(melted.contains("required"));
  CHECK(definitions["body"]["properties"]["temperature"]["type"] == nlohmann::ordered_json({"number", "string"}));
  CHECK(definitions["body"]["properties"]["temperature"]["description"] ==
        "Initial temperature, of x y z; with materials that have \"thermal\". Unit: K.");
}
