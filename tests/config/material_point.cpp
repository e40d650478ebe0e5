// Files whose solver is a material point: what they mean, and what is refused, with its place.
#include <string>

#include "config/config_support.hpp"
#include "drive/read_drive.hpp"
#include "drive/standard_paths.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::drive;

namespace {

const std::string good = R"({
  "title": "A rubber", "constants": {"top": 0.2},
  "materials": {"rubber": {"type": "neo_hookean", "youngs_modulus": "1 MPa", "poisson_ratio": 0.3, "density": 1000}},
  "solver": {
    "type": "material_point",
    "stages": [
      {"name": "pull", "duration": "10 ms", "steps": 5, "deformation_gradient": {"xx": "1 + top*t"}, "stress": {"yy": 0, "zz": "2 kPa"}},
      {"velocity_gradient": {"xy": 3}, "stress": {"xx": -1}}]},
  "compare": {"expect": [{"metric": "stages.pull.stress.xx", "at_least": 0}]}
})";

DriveExperiment read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return read_drive_text(text, "FILE", components(), overrides);
}

std::string refusal(std::string_view from, std::string_view to) {
  const std::string text = replaced(good, from, to);
  if (text == good) return "nothing was replaced";
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

bool says(const std::string& text, const std::string& part) {
  INFO(text);
  INFO("expected: " << part);
  CHECK(text.find(part) != std::string::npos);
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a material point's file is read into stages with components", "[config]") {
  const DriveExperiment path = read(good, {"/solver/stages/1/steps=7"});
  CHECK(path.experiment.title == "A rubber");
  CHECK(path.experiment.dimension == 3);
  CHECK(path.material().plugin->id() == "neo_hookean");
  CHECK(path.material().parameter("youngs_modulus") == 1e6);
  REQUIRE(path.stages.size() == 2);
  const drive::Stage &pull = path.stages[0], &shear = path.stages[1];
  CHECK((pull.name == "pull" && pull.duration == 0.01 && pull.steps == 5));
  CHECK(pull.motion == Motion::deformation_gradient);
  REQUIRE((pull.imposed.size() == 1 && pull.stresses.size() == 2));
  CHECK((pull.imposed[0].i == 0 && pull.imposed[0].j == 0));
  CHECK(pull.imposed[0].value({}, {}, 2) == Approx(1.4));
  CHECK((pull.stresses[1].i == 2 && pull.stresses[1].value({}, {}, 0) == 2000));
  CHECK((shear.name == "stage_2" && shear.duration == 1 && shear.steps == 7));
  CHECK(shear.motion == Motion::velocity_gradient);
  CHECK((shear.imposed[0].i == 0 && shear.imposed[0].j == 1));
  CHECK(path.experiment.expectations.size() == 1);
  CHECK(path.experiment.resolved["solver"]["stages"][0].dump() ==
        R"({"name":"pull","duration":0.01,"steps":5,"deformation_gradient":{"xx":"1 + top*t"},)"
        R"("stress":{"yy":0.0,"zz":2000.0}})");
  CHECK(read(path.experiment.resolved.dump()).experiment.resolved == path.experiment.resolved);
}

TEST_CASE("a material point's file is recognised by its solver, also after an override", "[config]") {
  const TemporaryFolder folder;
  CHECK(is_material_point(experiment_file(folder, good), {}));
  CHECK(!is_material_point(experiment_file(folder, two_discs), {}));
  CHECK(!is_material_point(experiment_file(folder, good), {"/solver/type=explicit"}));
}

TEST_CASE("a material point refuses what belongs to scenes, by name", "[config]") {
  says(
      refusal(R"("title": "A rubber")", R"("grid": {"cell_size": 1})"),
      R"(FILE:2:3: /grid: "grid" does not belong to a material point: it is one particle by itself, without grid, bodies and )"
      "time steps; remove it, or choose another solver");
  says(refusal(R"("title": "A rubber")", R"("backend": "cpu")"),
       R"("backend" does not belong to a material point: the material's )");
  says(refusal(R"("title": "A rubber")", R"("figures": ["energy"])"),
       R"("figures" does not belong to a material point: all steps )");
  says(refusal(R"("title": "A rubber")", R"("titel": "A rubber")"), R"(unknown key "titel"; did you mean "title"?)");
  says(refusal(R"("type": "material_point",)", R"("type": "material_point", "end_time": 1,)"),
       R"(unknown key "end_time")");
  says(refusal(R"("density": 1000)", R"("density": 1000, "thermal": {"conductivity": 1, "heat_capacity": 1})"),
       "/materials/rubber/thermal: a material point does not conduct");
  says(refusal(R"("density": 1000)", R"("density": 1000, "artificial_viscosity": {})"),
       "/materials/rubber/artificial_viscosity: a material point has no cells over which to spread a shock");
}

TEST_CASE("a material point refuses stages that impose too much, too little or what there is not", "[config]") {
  says(refusal(R"("stress": {"yy": 0,)", R"("stress": {"xx": 0,)"),
       R"(/solver/stages/0/stress/xx: the stage imposes this component under "deformation_gradient" too)");
  says(
      refusal(R"({"velocity_gradient")", R"({"deformation_gradient": {"yy": 1}, "velocity_gradient")"),
      R"(FILE:8:64: /solver/stages/1/velocity_gradient: a stage imposes "deformation_gradient" or "velocity_gradient", not both)");
  says(refusal(R"("stress": {"xx": -1})", R"("stress": {"yx": -1})"),
       R"(/solver/stages/1/stress/yx: unknown key "yx"; did you mean)");
  says(refusal(R"("name": "pull")", R"("name": "stage_2")"), R"(another stage is called "stage_2")");
  says(refusal(R"("name": "pull")", R"("name": "pull 2")"), R"("pull 2" is no name)");
  says(refusal(R"("1 + top*t")", R"("1 + x*t")"), "/solver/stages/0/deformation_gradient/xx: ");
  says(refusal(R"("2 kPa")", R"("2 mm")"), "expected a pressure (Pa), got a length (mm)");
  says(refusal(R"("steps": 5)", R"("steps": 0)"),
       "/solver/stages/0/steps: out of range: expected an integer from 1 to 1000000");
  says(refusal(R"("duration": "10 ms")", R"("duration": 0)"),
       "/solver/stages/0/duration: out of range: expected a time (s) above 0");
  const std::string from = good.substr(good.find("\"stages\": ["), good.find("]},") + 1 - good.find("\"stages\": ["));
  says(refusal(from, R"("stages": [])"), "/solver/stages: expected a list of stages, got none");
  says(refusal(from, R"("cell_size": 1)"), "/solver/stages: missing key");
  says(refusal(from, R"("cell_size": 1, "stages": [{}])"),
       R"(material "neo_hookean" does not read a cell size: remove it)");
}

TEST_CASE("a material point is of one material, and a plane one has the components in the plane", "[config]") {
  says(refusal(R"("materials": {)", R"("materials": {"other": {"type": "neo_hookean"}, )"),
       "/materials: a material point is of one material: expected an object with one, got one with 2");
  says(refusal(R"("title": "A rubber")", R"("dimension": 2)"), R"(/solver/stages/0/stress/zz: unknown key "zz")");
  const PathSize flat{0.1, 1, 10, 2};
  const OrderedJson material{{"type", "neo_hookean"}, {"youngs_modulus", 1}, {"poisson_ratio", 0}, {"density", 1}};
  for (const StandardPath& standard : standard_paths()) {
    CAPTURE(standard.name);
    CHECK(read(standard_path(standard.name, flat, material).dump()).experiment.dimension == 2);
  }
}
