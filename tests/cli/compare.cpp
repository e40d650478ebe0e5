// `mpm compare`: what differs between two runs, and the exit code that says whether anything does.

#include <cmath>

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

void run_as(const Folder& folder, const Json& scene, const std::string& name, const Words& more = {}) {
  spill(folder / (name + ".json"), scene.dump());
  Words words{"run", name + ".json", "--out", name, "--threads", "1"};
  words.insert(words.end(), more.begin(), more.end());
  const Result result = call(folder, words);
  INFO(result.err);
  REQUIRE(result.code == 0);
}

Result compare(const Folder& folder, const std::string& a, const std::string& b, const Words& more = {}) {
  Words words{"compare", a, b};
  words.insert(words.end(), more.begin(), more.end());
  return call(folder, words);
}

}  // namespace

TEST_CASE("two runs of one experiment are equal to the last bit") {
  const Folder folder;
  run_as(folder, two_balls(), "a");
  run_as(folder, two_balls(), "b");
  const Result result = compare(folder, "a", "b");
  INFO(result.out << result.err);
  CHECK(result.code == 0);
  CHECK(result.out == "all numbers that both have are the same\nequal\n");
  const Result json = compare(folder, "a", "b", {"--json"});
  CHECK(json.code == 0);
  const Json found = Json::parse(json.out);
  CHECK(found["equal"] == true);
  CHECK(found["largest_relative_difference"] == 0);
}

TEST_CASE("a number that was changed by hand is found with its place, difference and size") {
  const Folder folder;
  run_as(folder, ball(), "a");
  fs::copy(folder / "a", folder / "b", fs::copy_options::recursive);
  // The third row is that of step 10; its strain energy is held against the largest energy of the run.
  std::istringstream in(slurp(folder / "a/metrics.csv"));
  std::string out, header;
  std::getline(in, header);
  out = header + "\n";
  double largest = 0, before = 0;
  std::vector<std::string> names;
  std::istringstream cells(header);
  for (std::string cell; std::getline(cells, cell, ',');) names.push_back(cell);
  int row = 0;
  for (std::string line; std::getline(in, line); ++row) {
    std::istringstream values(line);
    std::string cell, changed;
    for (std::size_t k = 0; std::getline(values, cell, ','); ++k) {
      if (names[k].find(" (J") != std::string::npos && !has(names[k], "heat"))
        largest = larger(largest, std::abs(std::stod(cell)));
      if ((row == 1 || row == 2) && names[k].starts_with("strain energy")) {
        before = std::stod(cell);
        cell = Json(before + (row == 2 ? 1e-6 : 1e-7)).dump();
      }
      changed += (k ? "," : "") + cell;
    }
    out += changed + "\n";
  }
  spill(folder / "b/metrics.csv", out);
  Json summary = json_in(folder / "b/summary.json");
  summary["stability"]["largest_speed"] = 2 * summary["stability"]["largest_speed"].get<double>();
  summary["momentum"]["linear"]["final"]["x"] = 3;
  summary["performance"]["wall_seconds"] = 1e6;
  spill(folder / "b/summary.json", summary.dump());
  fs::remove(folder / "b/plan.json");

  const Result result = compare(folder, "a", "b", {"--json"});
  INFO(result.out << result.err);
  CHECK(result.code == 4);
  const Json found = Json::parse(result.out);
  CHECK(found["equal"] == false);
  REQUIRE(found["metrics"]["columns"].size() == 1);
  const Json& column = found["metrics"]["columns"][0];
  CHECK(column["name"].get<std::string>().starts_with("strain energy"));
  CHECK(column["step"] == 10);
  CHECK(column["time"].get<double>() == Approx(0.02));
  CHECK(column["absolute"].get<double>() == Approx(1e-6).epsilon(1e-6));
  CHECK(column["relative"].get<double>() == Approx(1e-6 / largest).epsilon(1e-6));
  REQUIRE(found["summary"]["numbers"].size() == 2);
  CHECK(found["summary"]["numbers"][0]["name"] == "/momentum/linear/final/x");
  const double scale = json_in(folder / "a/summary.json")["scales"]["momentum"];
  const double p = json_in(folder / "a/summary.json")["momentum"]["linear"]["final"]["x"];
  CHECK(found["summary"]["numbers"][0]["relative"].get<double>() == Approx(std::abs(p - 3) / std::max(scale, 3.0)));
  CHECK(found["summary"]["numbers"][1]["relative"].get<double>() == Approx(0.5));
  CHECK(found["files"]["only_in_first"] == Json{"plan.json"});

  const Result text = compare(folder, "a", "b", {"--tolerance", "0.01"});
  CHECK(text.code == 4);
  CHECK(has(text.out, "/stability/largest_speed: "));
  CHECK(!has(text.out, "strain energy"));  // it agrees within the tolerance
  CHECK(has(text.out, "files in the first alone:\n  plan.json\n"));
  CHECK(has(text.out, "not equal within the tolerance of 0.01"));
}

TEST_CASE("backends agree within rounding, and their keys are told but not judged") {
  const Folder folder;
  run_as(folder, two_balls(), "scene");
  run_as(folder, two_balls(), "other", {"--backend", "reference"});
  const Result strict = compare(folder, "scene", "other");
  CHECK(strict.code == 4);
  const Result result = compare(folder, "scene", "other", {"--tolerance", "1e-9"});
  INFO(result.out);
  CHECK(result.code == 0);
  CHECK(has(result.out, "/backend: \"cpu\" | \"reference\""));
  CHECK(has(result.out, "\nequal within the tolerance of 1e-09\n"));
}

TEST_CASE("what is zero by symmetry is held against its family, and the scale is said") {
  const Folder folder;
  Json scene = ball();  // a ball that falls on the floor: nothing pushes it along x, and nothing turns it
  scene["bodies"][0]["geometry"]["centre"] = {0.5, 0.25};
  scene["bodies"][0]["velocity"] = {0, -0.5};
  scene["output"]["reactions"] = {"y_min"};
  scene["output"]["bodies"] = true;
  run_as(folder, scene, "a");
  fs::copy(folder / "a", folder / "b", fs::copy_options::recursive);
  Json summary = json_in(folder / "a/summary.json");
  const double momentum = summary["scales"]["momentum"], time = summary["simulated_time"], mass = summary["mass"];
  const auto write = [&](const char* run, double force, double velocity) {
    Json& entry = summary["reaction"]["y_min"];
    entry["force"]["x"] = force, entry["mean_force"]["x"] = 0, entry["mean_force"]["y"] = 0;
    for (const char* when : {"initial", "final", "smallest", "largest"})
      for (const char* name : {"velocity_x", "velocity_y"}) summary["bodies"]["ball"][name][when] = 0;
    summary["bodies"]["ball"]["velocity_x"]["final"] = velocity;
    spill(folder / run / "summary.json", summary.dump());
  };
  write("a", 1e-15, 2e-17), write("b", -3e-15, -1e-17);
  const Result within = compare(folder, "a", "b", {"--tolerance", "1e-9"});
  INFO(within.out);
  CHECK(within.code == 0);
  const Json strict = Json::parse(compare(folder, "a", "b", {"--json"}).out);
  const auto found = [&](const Json& comparison, const std::string& name) -> Json {
    for (const Json& one : comparison["summary"]["numbers"])
      if (one["name"] == name) return one;
    return {};
  };
  // The floor pushes along y: that is the scale of its vector. The velocity's whole vector is nothing.
  const double push = std::abs(summary["reaction"]["y_min"]["force"]["y"].get<double>());
  REQUIRE(push > 1);
  const Json force = found(strict, "/reaction/y_min/force/x"),
             velocity = found(strict, "/bodies/ball/velocity_x/final");
  CHECK(force["relative"].get<double>() == Approx(4e-15 / push));
  CHECK(force["held_against"] == "the largest of its components over the run");
  CHECK(velocity["relative"].get<double>() == Approx(3e-17 / (momentum / mass)));
  CHECK(velocity["scale"].get<double>() == Approx(momentum / mass));
  CHECK(velocity["held_against"] == "sum of m |v| over the mass");
  // A force without any push along y is one of momentum over time.
  summary["reaction"]["y_min"]["force"]["y"] = 0;
  write("a", 1e-15, 0), write("b", -3e-15, 0);
  const Json alone = found(Json::parse(compare(folder, "a", "b", {"--json"}).out), "/reaction/y_min/force/x");
  CHECK(alone["relative"].get<double>() == Approx(4e-15 / (momentum / time)));
  CHECK(alone["held_against"] == "sum of m |v| over the simulated time");
  const Result text = compare(folder, "a", "b");
  CHECK(has(text.out, "/reaction/y_min/force/x: 1e-15 | -3e-15, differ by 4e-15, relative "));
  CHECK(has(text.out, " (sum of m |v| over the simulated time)"));
  // What is small and none the less a number of its own stays one.
  write("a", 1, 0), write("b", 1.01, 0);
  const Result other = compare(folder, "a", "b", {"--tolerance", "1e-4"});
  CHECK(other.code == 4);
  CHECK(has(other.out, "/reaction/y_min/force/x: 1 | 1.01, differ by 0.01, relative "));
}

TEST_CASE("a damaged file of a run is bad input, in one line") {
  const Folder folder;
  run_as(folder, ball(), "a");
  fs::copy(folder / "a", folder / "b", fs::copy_options::recursive);
  for (const char* name : {"summary.json", "experiment.json"}) {
    const std::string whole = slurp(folder / "b" / name);
    for (const std::string& text : {whole.substr(0, whole.size() / 2), std::string("[]"), std::string()}) {
      spill(folder / "b" / name, text);
      const Result damaged = compare(folder, "a", "b");
      INFO(damaged.out << damaged.err);
      CHECK(damaged.code == 2);
      CHECK(damaged.out.empty());
      CHECK(has(damaged.err,
                std::string("b/") + name + " is damaged: it holds no JSON object; run the experiment again\n"));
      CHECK(std::count(damaged.err.begin(), damaged.err.end(), '\n') == 2);  // and that nothing was compared
    }
    spill(folder / "b" / name, whole);
  }
  CHECK(compare(folder, "a", "b").code == 0);
}

TEST_CASE("equal experiments have equal pictures, whatever their folders are called") {
  const Folder folder;
  Json scene = ball();
  scene["figures"] = {"energy", "momentum"};
  scene["output"]["frames"] = 2;
  spill(folder / "scene.json", scene.dump());
  for (const char* run : {"one", "other"})
    REQUIRE(call(folder, {"run", "scene.json", "--out", run, "--threads", "1"}).code == 0);
  std::size_t pictures = 0;
  for (const char* place : {"figures", "frames"})
    for (const auto& entry : fs::directory_iterator(folder / "one" / place)) {
      const std::string name = entry.path().filename().string();
      INFO(name);
      CHECK(slurp(entry.path()) == slurp(folder / "other" / place / name));
      ++pictures;
    }
  CHECK(pictures > 6);
  for (const char* run : {"one", "other"})
    REQUIRE(call(folder, {"figure", run, "--out", std::string(run) + "_drawn"}).code == 0);
  CHECK(slurp(folder / "one_drawn/energy.svg") == slurp(folder / "other_drawn/energy.svg"));
  CHECK(slurp(folder / "one_drawn/energy.svg") == slurp(folder / "one/figures/energy.svg"));
  const Result same = compare(folder, "one", "other");
  INFO(same.out);
  CHECK(same.out == "all numbers that both have are the same\nequal\n");
}

TEST_CASE("rows, columns and words that one run alone has are differences at any tolerance") {
  const Folder folder;
  run_as(folder, ball(), "a");
  Json scene = ball();
  scene["output"]["ledger"] = false;
  scene["output"]["metrics_every"] = 7;
  run_as(folder, scene, "b");
  const Result result = compare(folder, "a", "b", {"--tolerance", "1"});
  INFO(result.out);
  CHECK(result.code == 4);
  CHECK(has(result.out, "/output/ledger: true | false"));
  CHECK(has(result.out, "metrics.csv has columns in the first alone:\n  ledger scatter (J/m)\n"));
  CHECK(has(result.out, "metrics.csv has 11 and 9 rows, of which 3 have the same step and are compared"));
  for (const auto& words : {Words{"compare", "a", "nowhere"}, Words{"compare", "a"}}) {
    const Result wrong = call(folder, words);
    CHECK(wrong.code == 2);
  }
  CHECK(has(call(folder, {"compare", "a", "nowhere"}).err, "nowhere holds no run (no manifest.json)"));
  spill(folder / "b/metrics.csv", "time (s),step\n0,0\n1,x\n");
  const Result damaged = compare(folder, "a", "b");
  CHECK(damaged.code == 2);
  CHECK(has(damaged.err, "metrics.csv"));
}
