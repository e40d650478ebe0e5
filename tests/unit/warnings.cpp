// Warnings: each is given by a scene that deserves it, and by no other of these.
#include "run/warnings.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "run/particle_cells.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::app;
using namespace mpm::test;
using Json = nlohmann::ordered_json;

namespace {

std::string box(const std::string& name, const std::string& lower, const std::string& upper,
                const std::string& more = "") {
  return R"({"name": ")" + name + R"(", "material": "m", "geometry": {"type": "box", "lower": )" + lower +
         R"(, "upper": )" + upper + "}" + more + "}";
}

/// Bodies in a domain of 2 m with cells of 0.1 m.
std::string scene(const std::string& bodies, const std::string& more = "",
                  const std::string& shape = "bspline_quadratic", const std::string& transfer = "apic") {
  return R"({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 2]], "boundaries": {"all": "slip"}},
    "shape": {"type": ")" +
         shape + R"("}, "transfer": {"type": ")" + transfer + R"("},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 10}},
    "bodies": [)" +
         bodies + R"(], "solver": {"time_step": 2e-3, "end_time": 0.2}, "output": {"ledger": false})" + more + "}";
}

const std::string coulomb = R"(, "contact": {"type": "coulomb", "friction": 0})";

Json losses(double numerical, double unexplained) {
  return {{"energy", {{"total", {{"gain", 0.0}, {"numerical_loss", numerical}, {"unexplained_loss", unexplained}}}}}};
}

/// The warnings of a run with a row a step. Every one names a page that is there.
std::vector<std::string> warned(const std::string& text, const Json& summary = Json::object(),
                                const std::vector<std::string>& overrides = {}) {
  Scene run(text, overrides);
  RunRecord rows(run.simulation, run.metrics);
  while (!run.simulation.finished()) {
    run.simulation.step();
    rows.take(run.metrics.measure(), {});
  }
  const std::vector<std::string> all = warnings_of(run.simulation, run.metrics, rows, summary);
  for (const std::string& warning : all) {
    INFO(warning);
    const auto open = warning.rfind("(docs/");
    REQUIRE(open != std::string::npos);
    const std::string page = warning.substr(open + 1, warning.find_first_of("#)", open + 1) - open - 1);
    CHECK(std::filesystem::is_regular_file(std::string(MPM_SOURCE_DIR) + "/" + page));
  }
  return all;
}

/// Whether the one and only warning has these words.
bool only(const std::vector<std::string>& all, const std::string& words) {
  for (const std::string& warning : all) UNSCOPED_INFO(warning);
  return all.size() == 1 && all.front().find(words) != std::string::npos;
}

const std::string one_box = box("b", "[0.5, 0.5]", "[1, 1]");

}  // namespace

TEST_CASE("much energy lost without a cause is warned of, unless the file sets a limit or the scene is driven",
          "[warnings]") {
  CHECK(warned(scene(one_box), losses(0.2, 0.2)).empty());
  CHECK(only(warned(scene(one_box), losses(0.98, 0)), "98 % of the energy went in transfers"));
  CHECK(only(warned(scene(one_box), losses(0, 0.3)), "30 % of the energy went in the integration over time"));
  const std::string limited = R"(, "limits": {"numerical_loss": 0.1, "unexplained_loss": 0.1})";
  CHECK(warned(scene(one_box, limited), losses(0.98, 0.98)).empty());
  CHECK(warned(scene(one_box, R"J(, "body_force": ["sin(t)", 0])J"), losses(0.98, 0.98)).empty());
}

TEST_CASE("one particle a cell and axis where bodies touch is warned of", "[warnings]") {
  const auto meeting = [](const char* rows, const std::string& contact) {
    const std::string right = R"(, "velocity": [2, 0], "particles_per_cell_axis": )", left = R"(, "velocity": [-2, 0])";
    return scene(box("a", "[0.4, 0.5]", "[0.9, 1]", right + rows) + "," + box("b", "[1.1, 0.5]", "[1.6, 1]", left),
                 contact);
  };
  CHECK(only(warned(meeting("1", coulomb)), "body \"a\" has one particle a cell and axis"));
  CHECK(warned(meeting("2", coulomb)).empty());
  CHECK(warned(meeting("1", R"(, "contact": {"type": "stick"})")).empty());  // a weld detects nothing
  // Bodies that never meet.
  CHECK(warned(meeting("1", coulomb), Json::object(), {"/bodies/0/velocity=[-2, 0]", "/bodies/1/velocity=[2, 0]"})
            .empty());
}

TEST_CASE("a finite block that slides on B-splines is warned of", "[warnings]") {
  const auto sliding = [](const std::string& shape, const std::string& lower, const std::string& upper,
                          const std::string& velocity) {
    return scene(box("ground", "[0, 0]", "[2, 0.5]") + "," + box("block", lower, upper, R"(, "velocity": )" + velocity),
                 coulomb + R"(, "gravity": [0, -10])", shape);
  };
  CHECK(only(warned(sliding("bspline_quadratic", "[0.4, 0.5]", "[0.8, 0.8]", "[2, -0.1]")),
             "body \"block\", a finite block, slid "));
  CHECK(warned(sliding("bspline_quadratic", "[0.4, 0.5]", "[0.8, 0.8]", "[2, -0.1]"), Json::object(),
               {"/contact/normal=widest_gap"})
            .empty());
  CHECK(warned(sliding("gimp", "[0.4, 0.5]", "[0.8, 0.8]", "[2, -0.1]")).empty());
  CHECK(warned(sliding("bspline_quadratic", "[0.4, 0.5]", "[0.8, 0.8]", "[0, -0.9]")).empty());  // it hits and stays
  CHECK(warned(sliding("bspline_quadratic", "[0, 0.5]", "[2, 0.8]", "[0, -0.1]")).empty());      // it has no corners
}

TEST_CASE("linear shapes in motion across cells are warned of, and smaller steps are no remedy", "[warnings]") {
  const std::string flying = box("b", "[0.5, 0.5]", "[1, 1]", R"(, "velocity": [1, 0])");
  CHECK(only(warned(scene(flying, "", "linear")), "neither smaller cells nor smaller steps help"));
  CHECK(warned(scene(flying)).empty());
  CHECK(warned(scene(one_box, "", "linear")).empty());
}

TEST_CASE("particles that ended alone are counted", "[warnings]") {
  const std::string grain = box("grain", "[1.5, 1.5]", "[1.55, 1.55]");
  CHECK(only(warned(scene(one_box + "," + grain)), "1 of 101 particles ended alone"));
  // In the reach of another one: 0.15 m of a quadratic B-spline.
  CHECK(warned(scene(one_box + "," + box("grain", "[1.1, 0.9]", "[1.15, 0.95]"))).empty());
  const Scene apart(scene(one_box + "," + box("grain", "[1.15, 0.9]", "[1.2, 0.95]")));
  CHECK(lone_particles(apart.simulation) == 1);  // 0.2 m
  const Scene touching(scene(one_box + "," + grain, "", "bspline_cubic"));
  CHECK(lone_particles(touching.simulation) == 1);
}

TEST_CASE("a soft body in the velocity field of one that wants a hundredth of its steps is warned of", "[warnings]") {
  const std::string text =
      scene(box("soft", "[0.5, 0.5]", "[0.8, 0.8]") + ", " +
            R"({"name": "stiff", "material": "hard", "geometry": {"type": "box", "lower": [0.8, 0.5],
                                 "upper": [1.1, 0.8]}})");
  const auto of = [&](const std::string& transfer, double modulus, const std::string& more = "") {
    const std::vector<std::string> hard{R"(/materials/hard={"type": "neo_hookean", "youngs_modulus": )" +
                                            digits(modulus) + R"(, "poisson_ratio": 0.3, "density": 10})",
                                        "/transfer/type=" + transfer, "/solver/time_step=1e-6",
                                        "/solver/end_time=3e-6"};
    std::vector<std::string> all = hard;
    if (!more.empty()) all.push_back(more);
    return warned(text, Json::object(), all);
  };
  const auto warns = [](const std::vector<std::string>& warnings, const std::string& part) {
    return warnings.size() == 1 && warnings.front().find(part) != std::string::npos;
  };
  CHECK(warns(of("apic", 1.1e7), "body \"soft\" shares a velocity field with \"stiff\", which wants steps 105 times"));
  CHECK(warns(of("apic", 1.1e7), "transfer \"apic\" damps it"));
  CHECK(of("pic", 1.1e7, R"(/filter={"type": "fmpm", "order": 4})").empty());  // no study has measured filters
  CHECK(of("apic", 0.9e7).empty());                                            // 95 times
  CHECK(of("flip", 1.1e7).empty());
  CHECK(of("apic", 1.1e7, R"(/contact={"type": "frictionless"})").empty());
  CHECK(of("apic", 1.1e7, "/bodies/0/frozen=true").empty());
}

TEST_CASE("a crack on B-splines whose law was told of one cell is warned of", "[warnings]") {
  const auto of = [](const std::string& shape, double band, double damage) {
    const std::vector<std::string> all{
        R"(/materials/m={"type": "damage", "youngs_modulus": 1000, "poisson_ratio": 0.2, "density": 10, "tensile_strength": 10,
          "fracture_energy": 10, "band_cells": )" +
            digits(band) + "}",
        "/solver/end_time=0.01"};
    const Json cracked{{"energy", {{"ledger", {{"damage", damage}}}}}};
    const Json summary = damage < 0 ? Json::object() : cracked;  // without a ledger
    return warned(scene(box("plate", "[0.5, 0.5]", "[1.5, 1]"), "", shape), summary, all);
  };
  const auto warnings = of("bspline_quadratic", 1, 0.1);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings.front().find("material \"m\" softens over a band of 1 cells") == 0);
  CHECK(of("bspline_quadratic", 2, 0.1).empty());
  CHECK(of("bspline_quadratic", 1, 0).empty());
  CHECK(of("bspline_quadratic", 1, -1).empty());
  CHECK(of("gimp", 1, 0.1).empty());
}

TEST_CASE("contact that acts across an open gap is warned of", "[warnings]") {
  // Blocks whose corners are half a cell off each other, which are still a cell apart at the end where they are slow.
  const auto blocks = [](const std::string& speed) {
    return scene(box("a", "[0.4, 0.5]", "[0.8, 1]", ", \"velocity\": [" + speed + ", 0]") + "," +
                     box("b", "[1.1, 0.55]", "[1.5, 1.05]", ", \"velocity\": [-" + speed + ", 0]"),
                 coulomb);
  };
  CHECK(only(warned(blocks("0.5")), "contact acted while a gap of 1 cells was open between the bodies"));
  CHECK(warned(blocks("2")).empty());
  CHECK(only(warned(blocks("0.5"), Json::object(), {"/contact/detection=approach"}),
             "detection \"approach\" does not know where the surfaces are; take \"approach_and_position\""));
}

TEST_CASE("the gap between fields is the distance of their particles' squares", "[warnings]") {
  const std::string near = box("a", "[0.5, 0.5]", "[1, 1]") + "," + box("b", "[1.15, 0.5]", "[1.5, 1]");
  CHECK(gap_between_fields(Scene(scene(near, coulomb)).simulation) == Approx(0.15));
  const std::string far = box("a", "[0.5, 0.5]", "[1, 1]") + "," + box("b", "[1.5, 1.5]", "[1.8, 1.8]");
  CHECK(gap_between_fields(Scene(scene(far, coulomb)).simulation) == Approx(0.2));  // two cells or more
  CHECK(std::isnan(gap_between_fields(Scene(scene(one_box)).simulation)));
}
