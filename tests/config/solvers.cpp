// The solver section: "type" chooses the solver, whose own keys it then has.
#include <algorithm>

#include "config/config_support.hpp"
#include "experiment/schema.hpp"
#include "experiment/sections.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;
using Json = nlohmann::ordered_json;

namespace {

const std::string solver_text = R"("solver": {"stress_update": "modified_last", "time_step": "1 ms", "end_time": 3.5})";

/// A second solver, as the program would offer it: its key "sweeps" stands in for what a solver reads.
ReadOptions with_sweeping() {
  ReadOptions offered = options();
  offered.solvers.push_back(
      {"sweeping",
       "Sweeps.",
       {parameter("sweeps", ParameterType::integer, "", "Sweeps a step.").from(1).to(50).standard(5),
        end_time_parameter(), max_steps_parameter()},
       [](const Fields& fields, SolverSpecification& solver) { solver.courant = fields.number("sweeps"); }});
  return offered;
}

Experiment read_with(const std::string& solver, const ReadOptions& offered) {
  return read_experiment_text(replaced(two_discs, solver_text, solver), "FILE", components(), offered);
}

std::string refusal(const std::string& solver, const ReadOptions& offered = options()) {
  const std::string changed = replaced(two_discs, solver_text, solver);
  return changed == two_discs ? "nothing was replaced" : errors_with(changed, offered);
}

}  // namespace

TEST_CASE("a solver without a type is the explicit one, and resolves as ever", "[config]") {
  const Experiment silent = read_text(two_discs);
  CHECK(silent.solver.type == "explicit");
  CHECK(silent.resolved["solver"].dump() ==
        R"({"type":"explicit","stress_update":"modified_last","time_step":0.001,"courant":0.3,"end_time":3.5,)"
        R"("dilation":"own","passes":"auto","max_steps":1000000000})");
  const Experiment named = read_with(R"("solver": {"type": "explicit", "stress_update": "modified_last",
    "time_step": "1 ms", "end_time": 3.5})",
                                     options());
  CHECK(named.resolved == silent.resolved);
  CHECK(named.resolved.dump() == silent.resolved.dump());
}

TEST_CASE("a solver that does not exist is refused by name, with those that do", "[config]") {
  CHECK(refusal(R"("solver": {"type": "newmark", "end_time": 1})") ==
        R"(FILE:32:22: /solver/type: unknown solver "newmark"; available: "explicit")");
  CHECK(refusal(R"("solver": {"type": "swepping", "end_time": 1})", with_sweeping()) ==
        R"(FILE:32:22: /solver/type: unknown solver "swepping"; did you mean "sweeping"? )"
        R"((available: "explicit", "sweeping"))");
  CHECK(refusal(R"("solver": {"type": 3, "end_time": 1})") ==
        "FILE:32:22: /solver/type: expected a string (solver), got the number 3");
  CHECK(refusal(R"("solver": "explicit")") ==
        "FILE:32:13: /solver: expected an object (solver), got the string \"explicit\"");
  ReadOptions none = options();
  none.solvers.clear();
  CHECK(refusal(R"("solver": {"type": "explicit", "end_time": 1})", none) ==
        R"(FILE:32:22: /solver/type: unknown solver "explicit"; no solver is available)");
}

TEST_CASE("a solver has its own keys and those that all have", "[config]") {
  const ReadOptions offered = with_sweeping();
  const Experiment sweeping =
      read_with(R"("solver": {"type": "sweeping", "sweeps": 7, "end_time": "20 ms", "max_steps": 4})", offered);
  CHECK(sweeping.solver.type == "sweeping");
  CHECK(sweeping.solver.courant == 7);
  CHECK(sweeping.solver.end_time == 0.02);
  CHECK(sweeping.solver.max_steps == 4);
  CHECK(sweeping.resolved["solver"].dump() == R"({"type":"sweeping","sweeps":7,"end_time":0.02,"max_steps":4})");
  CHECK(refusal(R"("solver": {"type": "sweeping", "courant": 0.5})", offered) ==
        "FILE:32:13: /solver/end_time: missing key; expected a time (s) above 0\n"
        R"(FILE:32:34: /solver/courant: unknown key "courant"; valid keys: "type", "sweeps", "end_time", "max_steps")");
  CHECK(refusal(R"("solver": {"sweeps": 7, "end_time": 1})", offered) ==
        R"(FILE:32:14: /solver/sweeps: unknown key "sweeps"; valid keys: "type", "stress_update", "time_step", )"
        R"("courant", "end_time", "dilation", "passes", "max_steps")");
}

TEST_CASE("the schema lists the solvers, and lets the type be left out for the explicit one alone", "[schema]") {
  const Json solver = json_schema(components(), with_sweeping())["$defs"]["solver"];
  CHECK(solver["properties"]["type"]["enum"] == Json({"explicit", "sweeping"}));
  CHECK(solver["properties"]["type"]["default"] == "explicit");
  CHECK(!solver.contains("required"));
  const Json &standard = solver["allOf"][0], &other = solver["allOf"][1];
  CHECK(!standard["if"].contains("required"));
  CHECK(standard["then"]["required"] == Json({"end_time"}));
  for (const char* key :
       {"type", "stress_update", "time_step", "courant", "end_time", "dilation", "passes", "max_steps"})
    CHECK(standard["then"]["properties"].contains(key));
  CHECK(standard["then"]["properties"].size() == 8);
  CHECK(other["if"]["required"] == Json({"type"}));
  CHECK(other["then"]["required"] == Json({"type", "end_time"}));
  CHECK(other["then"]["properties"].contains("sweeps"));
  CHECK(!other["then"]["properties"].contains("courant"));
}

TEST_CASE("every solver has the common keys, each key once, and says what it does", "[config]") {
  std::vector<std::string> ids;
  for (const Solver& solver : solvers()) {
    INFO(solver.id);
    ids.emplace_back(solver.id);
    CHECK(!solver.summary.empty());
    std::vector<std::string> keys{"type"};
    for (const ParameterSpec& key : solver.parameters()) {
      keys.push_back(key.name);
      CHECK(!key.doc.empty());
    }
    for (const char* common : {"end_time", "max_steps"}) CHECK(std::count(keys.begin(), keys.end(), common) == 1);
    std::sort(keys.begin(), keys.end());
    CHECK(std::adjacent_find(keys.begin(), keys.end()) == keys.end());
  }
  std::sort(ids.begin(), ids.end());
  CHECK(std::adjacent_find(ids.begin(), ids.end()) == ids.end());
  CHECK(solvers().front().id == "explicit");
}
