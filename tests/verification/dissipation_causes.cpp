// The rows of the energy ledger that say by what materials dissipate: plastic work, viscous flow, damage, a change of phase
// (docs/method.md, "The energy ledger").

#include <map>

#include "support/catch.hpp"
#include "support/results.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double rate = 0.5, viscosity = 3, side = 0.4, end = 0.4;

const std::map<std::string, std::string> laws{
    {"fluid", R"("type": "newtonian_fluid", "bulk_modulus": 2000, "viscosity": )" + digits(viscosity)},
    {"metal", R"("type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "yield_stress": 20)"},
    {"cracking", R"("type": "damage", "youngs_modulus": 1000, "poisson_ratio": 0.2, "tensile_strength": 20,
       "fracture_energy": 2, "band_cells": 2)"},
    {"rubber", R"("type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3)"}};

/// Squares side by side, each of a law of its own, whose nodes all have the velocity (rate y, 0), whatever the stresses
/// are. `more` is text of further keys of every material.
std::string sheared(const std::vector<std::string>& names, const std::string& more = "") {
  std::string materials, bodies;
  for (const std::string& name : names) {
    const double x = name == "fluid" ? 0.5 : name == "metal" ? 1.5 : name == "cracking" ? 2.5 : 3.5;
    const std::string comma = materials.empty() ? "" : ", ";
    materials += comma + "\"" + name + "\": {" + laws.at(name) + R"(, "density": 800)" + more + "}";
    bodies += comma + R"({"name": ")" + name + R"(", "material": ")" + name +
              R"(", "geometry": {"type": "box", "lower": [)" + digits(x) + ", 0.3], \"upper\": [" + digits(x + side) +
              ", " + digits(0.3 + side) + "]}}";
  }
  return R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [4.5, 1]], "boundaries": {"all": "free"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"}, "materials": {)J" +
         materials + R"J(}, "bodies": [)J" + bodies + R"J(],
    "node_conditions": [{"type": "prescribed", "lower": [0, 0], "upper": [4.5, 1], "velocity": [")J" +
         digits(rate) + R"J(*y", "0"]}], "solver": {"time_step": 0.002, "end_time": )J" + digits(end) + "}}";
}

Ledger ledger_of(const std::string& text, const std::string& backend) {
  Scene scene(text, {set("/backend", backend)});
  scene.run();
  return scene.simulation.ledger();
}

double sum_of_causes(const Ledger& ledger) {
  return ledger.plastic_work + ledger.viscous_flow + ledger.damage + ledger.phase_change + ledger.artificial_viscosity;
}

std::vector<std::string> names_of_rows(const Scene& scene) {
  std::vector<std::string> names;
  for (const ValueRow& row : scene.metrics.ledger_rows(scene.metrics.initial())) names.push_back(row.name);
  return names;
}

bool has_row(const Scene& scene, const std::string& name) {
  const std::vector<std::string> names = names_of_rows(scene);
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

// A fluid in steady simple shear dissipates its viscosity times the rate squared, a unit of volume and time (Batchelor 1967,
// An Introduction to Fluid Dynamics, eq. 3.4.5).
TEST_CASE("each law's dissipation stands in the row of its cause, and the causes add up", "[ledger]") {
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    const Ledger all = ledger_of(sheared({"fluid", "metal", "cracking", "rubber"}), backend);
    CHECK(all.viscous_flow == Approx(viscosity * rate * rate * side * side * end).epsilon(1e-3));
    const auto alone = [&](const std::string& name) { return ledger_of(sheared({name}), backend).material; };
    CHECK(all.plastic_work == Approx(alone("metal")).epsilon(1e-9));
    CHECK(all.damage == Approx(alone("cracking")).epsilon(1e-9));
    CHECK(alone("rubber") == 0);
    CHECK(all.plastic_work > 0.01);
    CHECK(all.damage > 0.01);
    CHECK(all.phase_change == 0);
    CHECK(all.artificial_viscosity == 0);
    CHECK(sum_of_causes(all) == Approx(all.material).epsilon(1e-12));
  }
}

TEST_CASE("artificial viscosity is no plastic work", "[ledger]") {
  // A square that is pressed together along x while all its nodes are told.
  std::string pressed = sheared({"metal"}, R"(, "artificial_viscosity": {"linear": 0.7, "quadratic": 1.9})");
  const std::string told = digits(rate) + "*y\"", x = "-" + digits(rate) + "*(x-1.7)\"";
  pressed.replace(pressed.find(told), told.size(), x);
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    const Ledger ledger = ledger_of(pressed, backend);
    CHECK(ledger.artificial_viscosity > 0.01 * ledger.material);
    CHECK(ledger.plastic_work > 0.01 * ledger.material);
    CHECK(sum_of_causes(ledger) == Approx(ledger.material).epsilon(1e-12));
  }
}

// In simple shear by g the square stores mu g^2/2 a unit of volume (neo-Hookean, J = 1). It melts as the nodes pass its melting
// temperature, to half the stiffness: half of what it stores then goes.
TEST_CASE("what is stored and goes as a solid melts stands in the row of the change of phase", "[ledger]") {
  const std::string phases =
      R"(, "thermal": {"conductivity": 1, "heat_capacity": 10, "phase_change": {"temperature": 300,
      "latent_heat": 1e-3, "melted": {"conductivity": 1, "heat_capacity": 10, "youngs_modulus": 500}}})";
  std::string text = sheared({"rubber"}, phases);
  const std::string condition = R"("type": "prescribed", )";
  text.insert(text.find(condition) + condition.size(), R"("temperature": "270+100*t", )");
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    Scene scene(text, {set("/backend", backend), set("/bodies/0/temperature", "270")});
    scene.run();
    const Ledger ledger = scene.simulation.ledger();
    const double stiffness = 1000 / 2.6, melts_at = 0.3, shear = rate * melts_at;
    const double stored = 0.5 * stiffness * shear * shear * side * side;
    INFO(ledger.phase_change << " of " << stored);
    CHECK(ledger.phase_change == Approx(0.5 * stored).epsilon(0.03));
    CHECK(ledger.material == ledger.phase_change);
  }
}

TEST_CASE("a ledger has rows of the causes that its scene can have", "[ledger]") {
  const auto check = [](const std::string& text, const std::vector<std::string>& expected) {
    const Scene scene(text);
    for (const char* row : {"plastic work", "viscous flow", "damage", "phase change"}) {
      INFO(row);
      CHECK(has_row(scene, row) == (std::find(expected.begin(), expected.end(), row) != expected.end()));
    }
    CHECK(has_row(scene, "material dissipation"));
  };
  check(sheared({"rubber"}), {});
  check(sheared({"metal", "rubber"}), {"plastic work"});
  check(sheared({"fluid", "cracking"}), {"viscous flow", "damage"});
}
