// What scenes with temperature cannot have, with the plugins of the build.
#include <set>

#include "experiment/read.hpp"
#include "experiment/thermal.hpp"
#include "solvers/solver.hpp"
#include "support/catch.hpp"

using namespace mpm;

namespace {

const Registry& plugins() {
  static const Registry registry = Registry::from_folders(Registry::default_folders());
  return registry;
}

Experiment experiment_from(const std::string& text, const std::vector<std::string>& overrides = {}) {
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.overrides = overrides;
  return read_experiment_text(text, "test.json", ComponentLookup(plugins()), options);
}

}  // namespace

TEST_CASE("two transfers do not carry a temperature, for stated reasons", "[config]") {
  std::set<std::string> refused;
  for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER)) {
    CHECK_FALSE((transfer->id() != "rpic" && refusal_of_temperature(*transfer, 0)));
    if (refusal_of_temperature(*transfer, transfer->id() == "polypic" ? 1 : 0))
      refused.insert(std::string(transfer->id()));
  }
  CHECK(refused == std::set<std::string>{"polypic", "rpic"});
  const auto reason = [](const char* id, int order) {
    return refusal_of_temperature(*plugins().find(MPM_TRANSFER, id), order).value_or("carried");
  };
  CHECK(reason("rpic", 0) ==
        "transfer \"rpic\" keeps the spin of a velocity alone, and a temperature has none; choose transfer \"apic\"");
  CHECK(reason("polypic", 2) ==
        "transfer \"polypic\" carries polynomials of a velocity beyond the affine ones, and none of a temperature; "
        "choose transfer \"apic\"");
}

TEST_CASE("no heat passes the axis of an axisymmetric scene", "[config]") {
  const std::string scene = R"J({ "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]], "symmetry": "axisymmetric",
             "boundaries": {"all": {"type": "slip", "temperature": 300}}},
    "shape": {"type": "linear"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
                        "thermal": {"conductivity": 1, "heat_capacity": 1}}},
    "bodies": [{"name": "b", "material": "m", "temperature": 300,
                "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.4, 0.4]}}],
    "solver": {"end_time": 1}})J";
  try {
    experiment_from(scene);
    FAIL("accepted");
  } catch (const InputError& error) {
    REQUIRE(error.problems().size() == 1);
    CHECK(error.problems()[0].pointer == "/grid/boundaries/all/temperature");
    CHECK(error.problems()[0].message ==
          "x_min is the axis r = 0, which is no wall and lets no heat through; set \"x_min\" to \"slip\"");
  }
  const Experiment wall = experiment_from(scene, {"/grid/boundaries/x_min=slip"});
  CHECK(wall.faces[0][1].thermal.exchange == HeatExchange::fixed_temperature);
}

TEST_CASE("a scene whose transfer does not carry a temperature has no plan", "[config]") {
  const auto refusal = [](const std::vector<std::string>& overrides) -> std::string {
    const Experiment experiment = experiment_from(R"J({ "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
    "shape": {"type": "bspline_quadratic"},
    "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
                        "thermal": {"conductivity": 1, "heat_capacity": 1}}},
    "bodies": [{"name": "b", "material": "m", "temperature": 300,
                "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.4, 0.4]}}],
    "solver": {"end_time": 1}})J",
                                                  overrides);
    try {
      make_plan(experiment);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  CHECK(refusal({"/transfer/type=\"rpic\""}) ==
        "test.json:4:17: /transfer: transfer \"rpic\" keeps the spin of a velocity alone, and a temperature has none; "
        "choose transfer \"apic\"");
  CHECK(refusal({"/transfer/type=\"polypic\""}) ==
        "test.json:4:17: /transfer: transfer \"polypic\" carries polynomials of a velocity beyond the affine ones, and "
        "none of a temperature; choose transfer \"apic\"");
  for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER)) {
    const std::string id(transfer->id());
    if (id != "rpic" && id != "polypic") CHECK(refusal({"/transfer/type=\"" + id + "\""}) == "accepted");
  }
  CHECK(refusal({"/solver/passes=\"fused\""}).find("temperature takes two passes") != std::string::npos);
}

TEST_CASE("transfers that carry gradients are refused with a linear shape where bodies move", "[config]") {
  const auto refusal = [](const std::string& shape, const std::string& transfer, bool frozen) {
    const std::string scene = R"J({ "dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
    "shape": {"type": ")J" + shape +
                              R"J("}, "transfer": {"type": ")J" + transfer + R"J("},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
      "thermal": {"conductivity": 10, "heat_capacity": 100}}},
    "bodies": [{"name": "b", "material": "m", "temperature": 300, "frozen": )J" +
                              (frozen ? "true" : "false") + R"J(,
                "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.4, 0.4]}}],
    "solver": {"end_time": 1}})J";
    try {
      make_plan(experiment_from(scene));
    } catch (const InputError& error) {
      REQUIRE(error.problems().size() == 1);
      return error.problems()[0].pointer + ": " + error.problems()[0].message;
    }
    return std::string("accepted");
  };
  for (const char* transfer : {"apic", "mls", "tpic", "aflip", "asflip"}) {
    CHECK(refusal("linear", transfer, false).starts_with("/shape: shape \"linear\" with transfer \""));
    CHECK(refusal("linear", transfer, true) == "accepted");
    CHECK(refusal("gimp", transfer, false) == "accepted");
  }
  for (const char* transfer : {"pic", "flip"}) CHECK(refusal("linear", transfer, false) == "accepted");
}

TEST_CASE("nothing is coloured by a temperature that no material has", "[config]") {
  const std::string scene = R"J({ "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
    "shape": {"type": "linear"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.4, 0.4]}}],
    "solver": {"end_time": 1}, "output": {"colour_by": "speed"}})J";
  for (const std::string quantity : {"temperature", "melted_fraction"}) {
    ReadOptions options;
    options.solvers = solver_descriptions();
    options.colour_quantities = {"speed", "temperature", "melted_fraction"};
    options.overrides = {"/output/colour_by=" + quantity};
    try {
      read_experiment_text(scene, "test.json", ComponentLookup(plugins()), options);
      FAIL("accepted " << quantity);
    } catch (const InputError& error) {
      REQUIRE(error.problems().size() == 1);
      CHECK(error.problems()[0].pointer == "/output/colour_by");
      CHECK(error.problems()[0].message.starts_with("nothing has a temperature here, as no material has \"thermal\""));
    }
  }
}

TEST_CASE("nothing is coloured by the melted fraction where nothing melts", "[config]") {
  const std::string scene = R"J({ "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
    "shape": {"type": "linear"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
                        "thermal": {"conductivity": 1, "heat_capacity": 1}}},
    "bodies": [{"name": "b", "material": "m", "temperature": 300,
                "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.4, 0.4]}}],
    "solver": {"end_time": 1}, "output": {"colour_by": "melted_fraction"}})J";
  try {
    experiment_from(scene);
    FAIL("accepted");
  } catch (const InputError& error) {
    REQUIRE(error.problems().size() == 1);
    CHECK(error.problems()[0].pointer == "/output/colour_by");
    CHECK(error.problems()[0].message.starts_with("nothing melts here, as no material has \"phase_change\""));
  }
  const std::string melts = R"(/materials/m/thermal/phase_change={"temperature": 300, "latent_heat": 1})";
  CHECK(experiment_from(scene, {melts}).output.colour_by == "melted_fraction");
}
