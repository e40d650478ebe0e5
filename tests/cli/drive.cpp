// Material points: files that `mpm run` takes, and `mpm drive`.

#include <array>
#include <cmath>
#include <sstream>

#include "cli/program.hpp"
#include "support/csv.hpp"

using namespace mpm::test;

namespace {

const Words rubber{"--param", "youngs_modulus=1e6", "--param", "poisson_ratio=0.3", "--param", "density=1 g/cm^3"};

Result drive(const Folder& folder, const std::string& id, Words more) {
  Words words{"drive", id};
  words.insert(words.end(), more.begin(), more.end());
  return call(folder, words);
}

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Json pulled() {
  return Json::parse(R"({
    "title": "Pulled", "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "solver": {"type": "material_point",
               "stages": [{"name": "pull", "steps": 10, "deformation_gradient": {"xx": "1 + t"}, "stress": {"yy": 0, "zz": 0}}]}
  })");
}

}  // namespace

TEST_CASE("drive: a row of each standard path, with the moduli of the material") {
  const Folder folder;
  const Result result = drive(folder, "neo_hookean", with(rubber, {"--strain", "1e-6", "--steps", "10"}));
  INFO(result.out << result.err);
  CHECK(result.code == 0);
  for (const char* part : {"uniaxial", "E = 1.000e+06", "simple_shear", "G = 3.846e+05", "isotropic", "K = 8.333e+05",
                           "cyclic", "oedometer", "M = 1.346e+06"})
    CHECK(has(result.out, part));
  CHECK(folder.names().empty());
  const Result one = drive(folder, "neo_hookean", with(rubber, {"--path", "oedometer", "--out", "runs"}));
  INFO(one.err);
  CHECK(one.code == 0);
  CHECK(!has(one.out, "uniaxial"));
  const auto table = mpm::support::read_csv(folder / "runs/oedometer/metrics.csv");
  CHECK(table.rows() == 201);
  CHECK(table.find("deformation gradient xx")->at(100) == Approx(0.9));
  CHECK(table.find("work")->back() == Approx(0).margin(1e-6));
  for (const char* name :
       {"figures/stress.png", "figures/stress_over_time.svg", "figures/energy_per_volume.csv", "report.html"})
    CHECK(fs::is_regular_file(folder / "runs/oedometer" / name));
  // What it wrote runs by itself.
  CHECK(call(folder, {"run", "runs/oedometer/experiment.json", "--out", "again"}).code == 0);
  CHECK(slurp(folder / "again/metrics.csv") == slurp(folder / "runs/oedometer/metrics.csv"));
}

TEST_CASE("drive: what is missing or wrong is code 2, and a path that cannot be followed code 3") {
  const Folder folder;
  const auto refused = [&](const std::string& id, const Words& more, const std::string& message) {
    const Result result = drive(folder, id, more);
    INFO(result.err);
    INFO("expected: " << message);
    CHECK(result.code == 2);
    CHECK(has(result.err, message));
    CHECK(result.out.empty());
  };
  refused("neo_hookean", {"--param", "density=1000"}, "youngs_modulus (Pa): Young's modulus at small strain");
  refused("neo_hookean", {}, "add --param youngs_modulus=… --param poisson_ratio=… --param density=…");
  refused("neo_hookaen", rubber, R"(no material is called "neo_hookaen"; did you mean "neo_hookean"?)");
  refused("neo_hookean", {"--param", "youngs_modulus=1e6", "--param", "density=1000", "--param", "poisson_ratio=0.7"},
          "mpm drive neo_hookean: /materials/m/poisson_ratio: out of range: expected a number above -1 and below 0.5");
  refused("neo_hookean", with(rubber, {"--param", "colour=red"}), R"(unknown key "colour")");
  refused("neo_hookean", with(rubber, {"--param", "colour"}), R"("colour" is not of the form name=value)");
  refused("neo_hookean", with(rubber, {"--path", "bent"}), "--path");
  refused("scene.json", {}, "runs with `mpm run`");
  refused("damage",
          {"--param", "youngs_modulus=1e9", "--param", "poisson_ratio=0.2", "--param", "density=1000", "--param",
           "tensile_strength=1e6", "--param", "fracture_energy=100"},
          R"(material "damage" reads the cell size of a grid: give --cell-size H, m)");
  Json scene = pulled();
  scene["solver"]["stages"][0]["deformation_gradient"]["xx"] = "1 - 2*t";
  spill(folder / "scene.json", scene.dump());
  const Result stopped = call(folder, {"run", "scene.json", "--out", "run"});
  INFO(stopped.err);
  CHECK(stopped.code == 3);
  CHECK(has(stopped.err, "the run failed: step "));
  CHECK(has(stopped.err, "remedy: "));
  CHECK(json_in(folder / "run/summary.json")["outcome"]["status"] == "failed");
  CHECK(has(slurp(folder / "run/report.html"), "exit code 3"));
}

TEST_CASE("run and check take material points, plan and options of scenes do not") {
  const Folder folder;
  Json scene = pulled();
  scene["compare"]["expect"] = {{{"metric", "stages.pull.stress.xx"}, {"equals", 1015.412883}, {"tolerance", 1e-5}}};
  spill(folder / "scene.json", scene.dump());
  const Result checked = call(folder, {"check", "scene.json"});
  CHECK(checked.code == 0);
  CHECK(has(checked.out, "scene.json: ok, a material point of neo_hookean, 3-D, 1 stage, 10 steps"));
  const Result ran = call(folder, {"run", "scene.json", "--out", "run"});
  INFO(ran.err);
  CHECK(ran.code == 0);
  CHECK(has(ran.out, "report: run/report.html"));
  CHECK(json_in(folder / "run/summary.json")["expect"][0]["held"] == true);
  const Result missed = call(folder, {"run", "scene.json", "--out", "run", "--set", "/compare/expect/0/equals=1000"});
  CHECK(missed.code == 4);
  CHECK(has(missed.err, "expected stages.pull.stress.xx 1000 within 1e-05, got 1015.41"));
  for (const auto& [words, message] :
       {std::pair{Words{"plan", "scene.json"}, "a material point has no plan"},
        std::pair{Words{"run", "scene.json", "--backend", "cpu"}, "it takes no backend"},
        std::pair{Words{"run", "scene.json", "--out", "run", "--resume"}, "it takes no checkpoints"}}) {
    const Result result = call(folder, words);
    INFO(result.err);
    CHECK(result.code == 2);
    CHECK(has(result.err, message));
  }
}

TEST_CASE("a material point's run can be held against another, and its figures are drawn by specification") {
  const Folder folder;
  spill(folder / "scene.json", pulled().dump());
  CHECK(call(folder, {"run", "scene.json", "--out", "a"}).code == 0);
  const auto table = mpm::support::read_csv(folder / "a/metrics.csv");
  REQUIRE(table.find("step"));
  CHECK(table.find("step")->back() == 10);
  CHECK(call(folder, {"run", "scene.json", "--out", "b", "--set", "/materials/m/youngs_modulus=1001"}).code == 0);
  const Result same = call(folder, {"compare", "a", "a"});
  INFO(same.out << same.err);
  CHECK(same.code == 0);
  CHECK(has(same.out, "all numbers that both have are the same"));
  CHECK(call(folder, {"compare", "a", "b"}).code == 4);
  for (const Words& runs : {Words{"a"}, Words{"a", "b"}}) {
    const Result bare = call(folder, with(with({"figure"}, runs), {"--out", "drawn"}));
    INFO(bare.err);
    CHECK(bare.code == 2);
    CHECK(has(bare.err,
              "a material point's run has its figures since it ran, in figures/; others are drawn with "
              "--spec FILE"));
    CHECK(!fs::exists(folder / "drawn"));
  }
  spill(folder / "spec.json", R"({"x": "deformation gradient xx", "y": "stress xx"})");
  CHECK(call(folder, {"figure", "a", "b", "--spec", "spec.json", "--out", "drawn"}).code == 0);
  CHECK(fs::is_regular_file(folder / "drawn/spec.png"));
}

// Of K (ln J)^2/2, K (J - 1)^2/2 and K ((J^2 - 1)/2 - ln J)/2 the stress is U', and its slope over ln J is J U''.
TEST_CASE("the figure of tangents has those of the three volumetric energies, and marks stand where they are given") {
  const Folder folder;
  const fs::path root = MPM_SOURCE_DIR;
  Words words{"figure"};
  for (const std::string energy : {"logarithmic", "quadratic", "simo"}) {
    REQUIRE(call(folder, {"run", (root / "experiments/material_point/crushed_and_torn.json").string(), "--set",
                          "/materials/rubber/volumetric_energy=" + energy, "--out", energy})
                .code == 0);
    words.push_back(energy);
  }
  const auto drawn = [&](const std::string& spec) {
    const Result result = call(folder, with(words, {"--spec", spec, "--out", "drawn"}));
    INFO(result.err);
    CHECK(result.code == 0);
  };
  drawn((root / "figures/material_point/volumetric_tangents.json").string());
  int points = 0;
  bool negative = false;
  for (const auto& row : mpm::support::read_csv_cells((folder / "drawn/volumetric_tangents.csv").string())) {
    if (row.size() < 4 || row[0] == "series") continue;
    const double J = std::stod(row[2]), slope = std::stod(row[3]);
    if (J > 97 || J < 0.0101 || J == 1) continue;  // at the ends of a way there are rows on one side alone
    const double exact = row[0] == "logarithmic" ? (1 - std::log(J)) / J : row[0] == "quadratic" ? J : (J + 1 / J) / 2;
    INFO(row[0] << ", J = " << J);
    CHECK(slope == Approx(1000 * exact).epsilon(1e-3).margin(0.1));
    ++points, negative |= slope < 0;
  }
  CHECK(points > 2000);
  CHECK(negative);

  spill(folder / "marks.json", R"({"x": "volume ratio", "y": "pressure", "log_y": true,
                                  "marks": [{"at": 0.1, "label": "one tenth"}, {"at": 1000, "label": "beyond"}]})");
  drawn("marks.json");
  const std::string picture = slurp(folder / "drawn/marks.svg");
  CHECK(has(picture, ">one tenth</text>"));
  CHECK(!has(picture, ">beyond</text>"));
  CHECK(has(picture, "1 mark outside the axis, left out"));
}

TEST_CASE("a signal stops a material point between two steps, and what was followed is written") {
  const Folder folder;
  Json scene = pulled();
  Json& stages = scene["solver"]["stages"];
  stages[0]["steps"] = 1000000;
  stages[0]["deformation_gradient"]["xx"] = "1 + 1e-3*t";
  stages.push_back(stages[0]);
  stages[1]["name"] = "on";
  spill(folder / "scene.json", scene.dump());
  const auto stopped = [&](const Words& words, const fs::path& run) {
    Process process(folder, program(words));
    REQUIRE(process.wait_until([&] { return fs::exists(folder / run / "experiment.json"); }));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    process.send(SIGINT);
    Result result = process.finish();
    INFO(result.err);
    REQUIRE(result.code == 130);
    const Json summary = json_in(folder / run / "summary.json");
    CHECK(summary["outcome"]["exit_code"] == 130);
    CHECK(summary["outcome"]["status"] == "interrupted");
    CHECK(has(result.err, "stopped by a signal after step " + summary["steps"].dump()));
    const auto table = mpm::support::read_csv(folder / run / "metrics.csv");
    CHECK(table.find("step")->back() == summary["steps"].get<double>());
    CHECK(table.find("time")->back() == summary["simulated_time"].get<double>());
    CHECK(has(slurp(folder / run / "report.html"), "</html>"));
    return result;
  };
  stopped({"run", "scene.json", "--out", "run"}, "run");
  const Result drive =
      stopped(with({"drive", "neo_hookean", "--steps", "1000000", "--out", "runs"}, rubber), "runs/uniaxial");
  CHECK(has(drive.out, "uniaxial"));
  CHECK(!fs::exists(folder / "runs/simple_shear"));
}

// Neo-Hookean: tau = mu (b - I) + lambda ln J I, so that p = -(mu (J^(2/3) - 1) + lambda ln J)/J where it is pressed alike from all
// sides, and the von Mises stress of a shear g is mu g sqrt(g^2 + 3).
TEST_CASE("drive: the figures of the extremes hold the law's closed form all along, and are replaced only on demand") {
  const Folder folder;
  const Words extremes = with(rubber, {"--extremes", "--cycles", "10", "--out", "far"});
  const Result result = drive(folder, "neo_hookean", extremes);
  INFO(result.out << result.err);
  CHECK(result.code == 0);
  CHECK(has(result.out, "figure: far/extremes_volume.png"));
  CHECK(fs::exists(folder / "far/extremes_shape.svg"));
  const double mu = 1e6 / 2.6, lambda = 1e6 * 0.3 / (1.3 * 0.4);
  int points = 0, sheared = 0;
  const auto each_row = [&](const char* name, const auto& visit) {
    std::istringstream lines(slurp(folder / "far" / name));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::array<std::string, 4> cells;
      std::istringstream fields(line);
      for (std::string& cell : cells) std::getline(fields, cell, ',');
      visit(cells[0], std::stod(cells[2]), std::stod(cells[3]));
    }
  };
  each_row("extremes_volume.csv", [&](const std::string& series, double J, double stress) {
    const double pressure = -(mu * (std::pow(J, 2.0 / 3) - 1) + lambda * std::log(J)) / J;
    CHECK((series == "pressure" ? pressure : -pressure) == Approx(stress).epsilon(1e-9));
    CHECK((series == "pressure") == (J < 1));
    ++points;
  });
  each_row("extremes_shape.csv", [&](const std::string& series, double size, double stress) {
    if (series != "sheared") return;
    CHECK(stress == Approx(mu * size * std::sqrt(size * size + 3)).epsilon(1e-9));
    ++sheared;
  });
  CHECK(points > 400);
  CHECK(sheared > 80);

  const Result again = drive(folder, "neo_hookean", extremes);
  CHECK(again.code == 2);
  CHECK(has(again.err, "far: holds extremes_volume.png already; add --replace, or choose another folder"));
  CHECK(again.out.empty());
  // A fluid without viscosity has no stress of shape: the figure of the material before goes, and that is said.
  const Result fluid = drive(folder, "inviscid_fluid",
                             {"--param", "bulk_modulus=1e6", "--param", "density=1000", "--extremes", "--cycles", "10",
                              "--out", "far", "--replace"});
  INFO(fluid.out << fluid.err);
  CHECK(fluid.code == 0);
  CHECK(has(fluid.out, "no figure extremes_shape: there is no stress anywhere"));
  CHECK(!fs::exists(folder / "far/extremes_shape.csv"));
  const Result long_name = drive(folder, "neo_hookean", with(rubber, {"--extremes", "--out", std::string(300, 'a')}));
  CHECK(long_name.code == 2);
  CHECK(has(long_name.err, "choose another folder, or a shorter name, with --out"));
  spill(folder / "file", "");
  const Result in_file = drive(folder, "every", {"--extremes", "--cycles", "10", "--out", "file"});
  CHECK(in_file.code == 2);
  CHECK(has(in_file.err, "file: is a file; choose a folder with --out"));
  const Result every = drive(folder, "every", {"--extremes", "--cycles", "10", "--out", "far"});
  CHECK(every.code == 0);
  CHECK(has(slurp(folder / "far/extremes_2.csv"), "neo_hookean,drawn by 10"));
  // The materials stand in figures of about as many rows each.
  std::vector<std::size_t> rows;
  for (int k = 1; fs::exists(folder / ("far/extremes_" + std::to_string(k) + ".csv")); ++k)
    rows.push_back(
        mpm::support::read_csv_cells((folder / ("far/extremes_" + std::to_string(k) + ".csv")).string()).size());
  REQUIRE(rows.size() >= 2);
  CHECK(*std::max_element(rows.begin(), rows.end()) - *std::min_element(rows.begin(), rows.end()) <= 5);
}

TEST_CASE("drive: options that say nothing or two things are refused, and numbers have their range") {
  const Folder folder;
  const auto refused = [&](const Words& more, const std::string& message) {
    const Result result = drive(folder, "neo_hookean", with(rubber, more));
    INFO(result.err);
    INFO("expected: " << message);
    CHECK(result.code == 2);
    CHECK(has(result.err, message));
    CHECK(result.out.empty());
  };
  refused({"--param", "type=hencky"}, "\"type\" is no parameter: the material is the word after `mpm drive`");
  refused({"--param", "density=2000"}, "\"density\" is given twice: 1 g/cm^3 and 2000");
  refused({"--replace"}, "--replace requires --out");
  refused({"--out", ""}, "--out: names no folder");
  for (const char* strain : {"nan", "1e-12", "0", "1", "-0.1", "wide"})
    refused({"--strain", strain}, std::string("--strain: expected a number from 1e-9 to 0.999, got ") + strain);
  for (const char* duration : {"nan", "0", "-1", "inf", "1e13"})
    refused({"--duration", duration}, std::string("--duration: expected a number from 1e-12 to 1e12, got ") + duration);
  const Result least = drive(folder, "neo_hookean", with(rubber, {"--strain", "1e-9", "--path", "uniaxial"}));
  INFO(least.out);
  CHECK(has(least.out, "E = 1.000e+06"));
  // A step of less keeps no digit of its strain: a dash in place of a number that says nothing.
  const Result lost =
      drive(folder, "neo_hookean", with(rubber, {"--strain", "1e-9", "--steps", "1000000", "--path", "simple_shear"}));
  INFO(lost.out);
  CHECK(has(lost.out, "G = -  "));
}

TEST_CASE("drive: a path that stops is told with its remedy also where nothing is written") {
  const Folder folder;
  const Result result = drive(folder, "neo_hookean", with(rubber, {"--strain", "0.999", "--steps", "1"}));
  INFO(result.out << result.err);
  CHECK(has(call(folder, {"drive", "--help"}).out, "5 the machine failed"));
  CHECK(result.code == 3);
  CHECK(has(result.out, "  stopped in step 1 of way_"));
  CHECK(has(result.out, "\n  remedy: "));
}

TEST_CASE("a study of a material point is refused in a sentence") {
  const Folder folder;
  spill(folder / "scene.json", pulled().dump());
  spill(folder / "study.json",
        R"({"base": "scene.json", "axes": {"/materials/m/youngs_modulus": {"values": [1000, 2000]}},
                                   "measure": {"work": {"value": "/energy_per_volume/work"}}})");
  for (const char* verb : {"study", "check"}) {
    const Result result = call(folder, {verb, "study.json"});
    INFO(result.err);
    CHECK(result.code == 2);
    CHECK(has(result.err, "a study runs scenes, and scene.json is a material point: run it by itself with `mpm run`"));
    CHECK(!has(result.err, "missing key"));
    CHECK(!fs::exists(folder / "runs"));
  }
}

TEST_CASE("the shipped material points hold what they expect") {
  const Folder folder;
  int files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(MPM_SOURCE_DIR) / "experiments/material_point")) {
    const Result result = call(folder, {"run", entry.path().string(), "--out", entry.path().stem().string()});
    INFO(entry.path() << result.err);
    CHECK(result.code == 0);
    ++files;
  }
  CHECK(files >= 3);
}
