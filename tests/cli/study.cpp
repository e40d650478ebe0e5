// `mpm study` and `mpm advise`: every combination a run of its own, whatever becomes of it.

#include <regex>

#include "cli/program.hpp"
#include "support/csv.hpp"

using namespace mpm::test;

namespace {

/// A ball that breathes: 52 particles, 25 steps.
Json breathing() {
  Json scene = ball();
  scene["bodies"][0]["velocity"] = {"0.3*(x-0.5)", "0.3*(y-0.5)"};
  scene["solver"] = {{"time_step", 0.01}, {"end_time", 0.25}};
  scene["output"] = {{"metrics_every", 1}, {"ledger", false}};
  scene["limits"] = {{"energy_gain", nullptr}};  // energy swings by some per cent within the steps
  return scene;
}

Json small_study() {
  return Json::parse(R"J({
    "title": "Small study", "base": "scene.json",
    "axes": {"/transfer/type": ["pic", "flip"], "/grid/cell_size": [0.1, 0.05]},
    "measure": {"loss": {"value": "/energy/total/final_over_initial", "formula": "abs(1-x)", "label": "energy lost"}},
    "error": "loss"
  })J");
}

void write_inputs(const Folder& folder, const Json& scene, const Json& study) {
  spill(folder / "scene.json", scene.dump(1));
  spill(folder / "s.json", study.dump(1));
}

Result run_study(const Folder& folder, Words more = {}) {
  Words words{"study", "s.json", "--out", "out", "--jobs", "2"};
  words.insert(words.end(), more.begin(), more.end());
  return call(folder, words);
}

/// The number as a figure's CSV writes it.
std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

Json run_named(const Json& study, const std::string& name) {
  for (const Json& run : study["runs"])
    if (run["name"] == name) return run;
  FAIL("no run is called " << name);
  return {};
}

std::vector<pid_t> children_of(pid_t id) {
  std::istringstream list(slurp("/proc/" + std::to_string(id) + "/task/" + std::to_string(id) + "/children"));
  std::vector<pid_t> children;
  for (pid_t child = 0; list >> child;) children.push_back(child);
  return children;
}

}  // namespace

TEST_CASE("a study runs every combination once, and only what changed again; advice comes from what it measured") {
  const Folder folder;
  Json study = small_study();
  study["figures"] = {{{"type", "convergence"}, {"x", "/grid/cell_size"}}, "pareto"};
  study["note"] = "All steps are short.";
  write_inputs(folder, breathing(), study);
  const Result first = run_study(folder);
  INFO(first.err);
  REQUIRE(first.code == 0);
  CHECK(has(first.out, "4 combinations: 4 done\nreport: out/report.html"));
  const Json json = json_in(folder / "out/study.json");
  CHECK(json["status"] == "complete");
  REQUIRE(json["runs"].size() == 4);
  const Json pic = run_named(json, "pic-0.1"), flip = run_named(json, "flip-0.1");
  CHECK(pic["measures"]["loss"].get<double>() > flip["measures"]["loss"].get<double>());
  CHECK(pic["measures"]["particle_steps"] == 52 * 25);
  const Json summary = json_in(folder / "out/runs/pic-0.1/summary.json");
  CHECK(pic["measures"]["loss"] == std::abs(1 - summary["energy"]["total"]["final_over_initial"].get<double>()));
  CHECK(pic["measures"]["flops"] == summary["performance"]["flops"]);
  const std::string front = slurp(folder / "out/figures/pareto_flops.csv");
  INFO(front);
  CHECK(has(front.substr(0, front.find('\n')), "floating-point operations"));
  for (const Json& run : json["runs"]) CHECK(has(front, "point," + digits(run["measures"]["flops"]) + ","));
  const std::string report = slurp(folder / "out/report.html");
  for (const char* part :
       {"Small study", "Observed orders", "Pareto fronts", "runs/pic-0.1/report.html", "data:image/svg"})
    CHECK(has(report, part));
  CHECK(!has(report, "src=\"http"));
  CHECK(has(slurp(folder / "out/table.csv"), "\npic-0.1,pic,0.1,done,"));
  for (const char* figure : {"convergence", "pareto_seconds", "pareto_particle_steps", "pareto_flops"})
    for (const char* ending : {".png", ".svg", ".csv"})
      CHECK(fs::is_regular_file(folder / "out/figures" / (std::string(figure) + ending)));

  // At equal cost one of the two coarse runs is better, and the table of the figure says which.
  const std::string named = slurp(folder / "out/figures/pareto_particle_steps.csv");
  INFO(named);
  CHECK(has(named, ",name,dominated by\n"));
  CHECK(has(named, ",\"pic, 0.1\",\"flip, 0.1\"\n"));
  CHECK(has(named, ",\"flip, 0.1\",\n"));

  const Result again = run_study(folder);
  CHECK(again.code == 0);
  CHECK(has(again.out, "4 done; 4 reused from an earlier call"));
  study["axes"]["/grid/cell_size"] = {0.1, 0.04};
  write_inputs(folder, breathing(), study);
  const Result changed = run_study(folder);
  INFO(changed.err);
  CHECK(has(changed.out, "4 done; 2 reused from an earlier call"));
  const Result other = run_study(folder, {"--set", "/solver/end_time=0.1"});
  CHECK(has(other.out, "4 combinations: 4 done\n"));
  CHECK(run_named(json_in(folder / "out/study.json"), "pic-0.1")["measures"]["particle_steps"] == 52 * 10);

  const Result advice = call(folder, {"advise", "out", "--error", "50%", "--by", "particle_steps"});
  INFO(advice.out << advice.err);
  CHECK(advice.code == 0);
  CHECK(advice.out.starts_with("note: All steps are short.\ntake flip, 0.1: energy lost "));
  CHECK(has(advice.out, "particle-steps 520\n"));
  CHECK(has(advice.out, "evidence: out/runs/flip-0.1\n"));
  const Result best = call(folder, {"advise", "out", "--time", "10 min", "--json"});
  CHECK(best.code == 0);
  const Json ranked = Json::parse(best.out);
  CHECK(ranked["note"] == "All steps are short.");
  CHECK(has(slurp(folder / "out/report.html"), "<strong>All steps are short.</strong>"));
  REQUIRE(ranked["good"].size() == 4);
  for (std::size_t k = 1; k < 4; ++k) CHECK(ranked["good"][k - 1]["error"] <= ranked["good"][k]["error"]);
  const Result none = call(folder, {"advise", "out", "--error", "1e-9"});
  CHECK(none.code == 4);
  CHECK(has(none.out, "note: All steps are short.\nno combination has energy lost of at most 1e-9\nnearest: "));
  // Another measure in the place of the error: two of the four take no more than 600 particle-steps.
  const Json other_error = Json::parse(
      call(folder, {"advise", "out", "--error", "600", "--by", "seconds", "--measure", "particle_steps", "--json"})
          .out);
  REQUIRE(other_error["good"].size() == 2);
  for (const Json& good : other_error["good"]) CHECK(good["error"] == 520);
  // Of a change with a sign the least is not the best.
  Json signed_study = json_in(folder / "out/study.json");
  for (Json& run : signed_study["runs"]) run["measures"]["loss"] = -1.0;
  fs::create_directory(folder / "signed");
  spill(folder / "signed/study.json", signed_study.dump());
  const Result below = call(folder, {"advise", "signed", "--error", "1", "--measure", "loss"});
  INFO(below.err);
  CHECK(below.code == 2);
  CHECK(has(below.err, R"("loss" is below zero in )"));
  const Result unknown = call(folder, {"advise", "out", "--error", "600", "--measure", "steps"});
  CHECK(unknown.code == 2);
  CHECK(has(unknown.err, "--measure"));
  CHECK(call(folder, {"advise", "out"}).code == 2);
  CHECK(call(folder, {"advise", "out", "--error", "1 mm"}).code == 2);
  CHECK(call(folder, {"advise", "nowhere", "--error", "1"}).code == 2);
}

TEST_CASE("advice repeats what the run that it names warned of") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"apic", "flip"}}};
  write_inputs(folder, two_balls(), study);
  REQUIRE(run_study(folder).code == 0);
  const std::string words = "the curved surface of body";
  const Result advice = call(folder, {"advise", "out", "--error", "90%", "--by", "particle_steps"});
  INFO(advice.out << advice.err);
  CHECK(advice.code == 0);
  CHECK(has(advice.out, "\nwarning: " + words));
  const Json ranked = Json::parse(call(folder, {"advise", "out", "--error", "90%", "--json"}).out);
  REQUIRE(ranked["good"].size() == 2);
  for (const Json& good : ranked["good"]) CHECK(has(good["warnings"].dump(), words));
  fs::remove(folder / "out/runs/apic/summary.json");  // and says nothing where the run's folder has gone
  fs::remove(folder / "out/runs/flip/summary.json");
  CHECK(!has(call(folder, {"advise", "out", "--error", "90%"}).out, "warning:"));
}

TEST_CASE("a study warns of a measure that no run has") {
  const Folder folder;
  Json study = small_study();
  study["measure"]["wrong"] = {{"value", "/energy.total/final"}, {"label", "misspelt"}};
  write_inputs(folder, breathing(), study);
  const Result result = run_study(folder);
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(has(result.err,
            "warning: measure \"wrong\": no run has a finite number at /energy.total/final of its summary.json"));
  CHECK(!has(result.err, "measure \"loss\""));
}

TEST_CASE("refused, unstable and flagged combinations are recorded by name") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"flip", "flop"}}, {"/solver/time_step", {0.01, 5}}};
  study["limits"] = {{"isolated", true}, {"volume_ratio", {0.9999, 1.0001}}};
  study["figures"] = {{{"type", "outcome_map"}, {"x", "/solver/time_step"}},
                      {{"type", "heat_map"}, {"x", "/solver/time_step"}, {"y", "/transfer/type"}}};
  Json scene = breathing();
  scene["solver"]["end_time"] = 100;  // 20 steps of 5 s
  scene["solver"]["max_steps"] = 100;
  write_inputs(folder, scene, study);
  Result result = run_study(folder, {"--set", "/solver/end_time=20", "--set", "/solver/max_steps=2500"});
  INFO(result.err);
  CHECK(result.code == 4);
  CHECK(has(result.out, "4 combinations: 1 done, 1 failed, 2 refused"));
  CHECK(has(result.err, "flip-0.01: smallest volume ratio J 0."));
  const Json json = json_in(folder / "out/study.json");
  const Json refused = run_named(json, "flop-0.01");
  CHECK(refused["status"] == "refused");
  CHECK(has(refused["reason"], "unknown transfer \"flop\"; did you mean \"flip\"?"));
  const Json failed = run_named(json, "flip-5");
  CHECK(failed["status"] == "failed");
  CHECK(has(failed["reason"], "particle"));
  CHECK(failed["measures"].empty());
  CHECK(has(slurp(folder / "out/report.html"), "flagged"));
  CHECK(fs::is_regular_file(folder / "out/figures/outcome_map.png"));
  CHECK(fs::is_regular_file(folder / "out/figures/heat_map.png"));
}

TEST_CASE("a cell of a heat map tells how many of its runs are bounded, and what became of the others") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"pic", "flip"}}, {"/grid/cell_size", {0.1, 0.05}}};
  study["axes"]["/limits"] = {
      {"values", {{{"energy_gain", nullptr}}, {{"energy_gain", 1}, {"volume_ratio", {0.9999, 2}}}}},
      {"labels", {"wide", "narrow"}}};
  study["figures"] = {{{"type", "heat_map"},
                       {"x", "/transfer/type"},
                       {"y", "/grid/cell_size"},
                       {"over", "/limits"},
                       {"take", "bounded"}}};
  write_inputs(folder, breathing(), study);
  const Result result = run_study(folder);
  INFO(result.err);
  CHECK(result.code == 4);
  CHECK(has(result.out, "8 combinations: 8 done"));
  const std::string csv = slurp(folder / "out/figures/heat_map.csv");
  INFO(csv);
  CHECK(has(csv, "runs bounded, of 2"));
  CHECK(has(csv, "0.1,flip,2,\n"));
  CHECK(has(csv, "0.05,pic,1,J1\n"));
}

TEST_CASE("a cell of a heat map says that a run which came to its end has no such number") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"pic", "flip"}}, {"/output/ledger", {true, false}}};
  study["measure"] = {{"gather", {{"value", "/energy/ledger/gather"}}}};
  study["figures"] = {{{"type", "heat_map"}, {"x", "/transfer/type"}, {"y", "/output/ledger"}, {"value", "gather"}}};
  study.erase("error");
  write_inputs(folder, breathing(), study);
  const Result result = run_study(folder);
  INFO(result.err);
  const std::string csv = slurp(folder / "out/figures/heat_map.csv");
  INFO(csv);
  CHECK(has(csv, "false,pic,,no value\n"));
  CHECK(!has(csv, "true,pic,,"));
}

TEST_CASE("bisection finds the largest stable step") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"flip"}}};
  study["bisect"] = {{"pointer", "/solver/time_step"},
                     {"from", 0.02},
                     {"to", 2},
                     {"relative_tolerance", 0.2},
                     {"stable_while", {{{"value", "/energy/total/largest_over_initial"}, {"at_most", 1.5}}}}};
  write_inputs(folder, breathing(), study);
  const Result result = run_study(folder, {"--set", "/solver/end_time=4"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  const Json run = run_named(json_in(folder / "out/study.json"), "flip");
  const double stable = run["bisection"]["stable"], unstable = run["bisection"]["unstable"];
  CHECK(stable < unstable);
  CHECK(unstable <= 1.2 * stable);
  CHECK(stable > 0.03);  // cell size over wave speed: 0.086 s
  CHECK(unstable < 0.4);
  CHECK(run["measures"]["critical"] == stable);
  for (const Json& probe : run["bisection"]["runs"]) CHECK(probe["stable"] == (probe["value"] <= stable));
  const Result again = run_study(folder, {"--set", "/solver/end_time=4"});
  CHECK(has(again.out, "1 reused"));
}

TEST_CASE("a bisection that sets something for its search measures the scene without it") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"flip"}}};
  study["measure"] = {{"end", "/simulated_time"}};
  study["bisect"] = {{"pointer", "/solver/time_step"},
                     {"from", 0.02},
                     {"to", 2},
                     {"relative_tolerance", 0.2},
                     {"set", {{"/solver/end_time", 4}}},
                     {"stable_while", {{{"value", "/simulated_time"}, {"at_least", 3.9}}}}};
  study.erase("error");
  study.erase("figures");
  write_inputs(folder, breathing(), study);
  const Result result = run_study(folder, {"--set", "/solver/end_time=1"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  const Json run = run_named(json_in(folder / "out/study.json"), "flip");
  CHECK(run["folder"] == "runs/flip");
  CHECK(run["measures"]["critical"] == run["bisection"]["stable"]);
  CHECK(run["measures"]["end"].get<double>() == Approx(1));  // the search ran to 4 s, or it would have found no step
  const Json made = json_in(folder / "out/runs/flip/experiment.json");
  CHECK(made["solver"]["time_step"] == run["bisection"]["stable"]);
  CHECK(has(run_study(folder, {"--set", "/solver/end_time=1"}).out, "1 reused"));
}

TEST_CASE("a run of a bisection that is killed ends the search, and is no unstable step") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"flip"}}};
  study["bisect"] = {{"pointer", "/solver/time_step"}, {"from", 0.001}, {"to", 0.01}};
  write_inputs(folder, endless_ball(), study);
  Process process(folder, program({"study", "s.json", "--out", "out", "--jobs", "1"}));
  REQUIRE(process.wait_until([&] { return rows_written(folder / "out/runs/flip@0.001/metrics.csv", 20); }));
  REQUIRE(children_of(process.id()).size() == 1);
  ::kill(children_of(process.id())[0], SIGKILL);
  const Result ended = process.finish();
  INFO(ended.out << ended.err);
  CHECK(ended.code == 4);
  const Json run = run_named(json_in(folder / "out/study.json"), "flip");
  CHECK(run["status"] == "crashed");
  CHECK(has(run["reason"], "at 0.001: ended by SIGKILL"));
  CHECK(!has(run["reason"], "unstable"));
}

TEST_CASE("a run that is killed is recorded, and run again by the next call") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"flip", "pic"}}};
  write_inputs(folder, endless_ball(), study);
  Process process(folder, program({"study", "s.json", "--out", "out", "--jobs", "1"}));
  const fs::path rows = folder / "out/runs/flip/metrics.csv";
  REQUIRE(process.wait_until([&] { return rows_written(rows, 20); }));
  REQUIRE(children_of(process.id()).size() == 1);
  ::kill(children_of(process.id())[0], SIGKILL);
  REQUIRE(process.wait_until([&] { return rows_written(folder / "out/runs/pic/metrics.csv", 20); }));
  process.send(SIGINT);
  const Result stopped = process.finish();
  INFO(stopped.err);
  CHECK(stopped.code == 130);
  const Json json = json_in(folder / "out/study.json");
  CHECK(json["status"] == "interrupted");
  CHECK(run_named(json, "flip")["status"] == "crashed");
  CHECK(has(run_named(json, "flip")["reason"], "SIGKILL"));
  CHECK(run_named(json, "pic")["status"] == "interrupted");
  CHECK(fs::is_regular_file(folder / "out/report.html"));

  Process more(folder, program({"study", "s.json", "--out", "out", "--jobs", "2"}));
  CHECK(more.wait_until([&] { return has(slurp(folder / "out/records/pic.log"), "resumed from step"); }));
  more.send(SIGKILL);
  CHECK(more.finish().signal == SIGKILL);
  // The study's runs end with it: soon nothing is written any more.
  const auto size = [&] { return fs::file_size(folder / "out/runs/pic/metrics.csv"); };
  bool still = false;
  for (int look = 0; look < 100 && !still; ++look) {
    const auto before = size();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    still = size() == before;
  }
  CHECK(still);
}

TEST_CASE("2: what a study sets wrongly is named with the study's line, what is wrong in its base with the base's") {
  const Folder folder;
  write_inputs(folder, breathing(), small_study());
  const auto refusal = [&](const std::string& study, const Words& verb) {
    spill(folder / "wrong.json", study);
    Words words = verb;
    words.emplace_back("wrong.json");
    const Result result = call(folder, words);
    INFO(result.err);
    CHECK(result.code == 2);
    return result.err;
  };
  for (const Words& verb : {Words{"check"}, Words{"study"}}) {
    const std::string axis =
        refusal("{\"base\": \"scene.json\",\n \"axes\": {\n  \"/transfer/type\": [\"flop\",\n   \"flup\"]}}", verb);
    CHECK(has(axis, "wrong.json: flop: wrong.json:3:22: /transfer/type: unknown transfer \"flop\""));
    CHECK(has(axis, "wrong.json: flup: wrong.json:4:4: /transfer/type: unknown transfer \"flup\""));
    const std::string within = refusal(
        "{\"base\": \"scene.json\",\n \"set\": {\"/solver\": {\"end_tim\": 1}},\n"
        " \"axes\": {\"/seed\": [1]}}",
        verb);
    CHECK(has(within, "wrong.json:2:21: /solver/end_tim: unknown key"));
    const std::string named = refusal(
        "{\"base\": \"scene.json\",\n \"axes\": {\"way\": {\"values\": [\n"
        "  {\"label\": \"a\", \"set\": {\"/grid/cell_size\": -1}}]}}}",
        verb);
    CHECK(has(named, "wrong.json:3:45: /grid/cell_size: "));
    const std::string nowhere = refusal("{\"base\": \"scene.json\",\n \"axes\": {\"/gird/cell_size\": [1]}}", verb);
    CHECK(has(nowhere, "wrong.json:2:31: /gird/cell_size: "));
    // The plan refuses it, after the file was read.
    const std::string planned = refusal(
        "{\"base\": \"scene.json\",\n \"set\": {\"/shape/type\": \"cpdi\"},\n \"axes\": {\"/transfer/type\":\n"
        "  [\"polypic\"]}}",
        verb);
    CHECK(has(planned, "wrong.json:4:4: /transfer: transfer \"polypic\" carries products"));
    Json base = breathing();
    base["solver"]["courant"] = 7;
    spill(folder / "scene.json", base.dump(1));
    const std::string of_base = refusal("{\"base\": \"scene.json\", \"axes\": {\"/seed\": [1]}}", verb);
    CHECK(std::regex_search(of_base, std::regex("1: scene\\.json:[0-9]+:[0-9]+: /solver/courant: ")));
    spill(folder / "scene.json", breathing().dump(1));
  }
}

TEST_CASE("2: studies that cannot be run leave nothing behind") {
  const Folder folder;
  Json study = small_study();
  write_inputs(folder, breathing(), study);
  CHECK(has(call(folder, {"study", "missing.json"}).err, "missing.json: there is no such file"));
  spill(folder / "bad.json", "{\"base\": \"scene.json\",\n \"axis\": {}}");
  const Result bad = call(folder, {"study", "bad.json"});
  CHECK(bad.code == 2);
  CHECK(has(bad.err, "bad.json:2:2: /axis: unknown key \"axis\"; did you mean \"axes\"?"));
  CHECK(has(bad.err, "bad.json:1:1: /axes: missing key"));
  CHECK(!fs::exists(folder / "runs"));

  study["axes"] = {{"/transfer/typ", {"pic", "flip"}}};
  write_inputs(folder, breathing(), study);
  const Result refused = run_study(folder);
  INFO(refused.err);
  CHECK(refused.code == 2);
  CHECK(has(refused.err, "s.json: pic: s.json:"));
  CHECK(has(refused.err, ": /transfer/typ: unknown key \"typ\"; did you mean \"type\"?"));
  CHECK(!fs::exists(folder / "out"));

  fs::create_directory(folder / "thesis");
  spill(folder / "thesis/chapter.tex", "years of work");
  const Result foreign = call(folder, {"study", "s.json", "--out", "thesis"});
  CHECK(foreign.code == 2);
  CHECK(has(foreign.err, "not an earlier study (no study.json)"));
  CHECK(slurp(folder / "thesis/chapter.tex") == "years of work");
}

TEST_CASE("curves of every so many rows keep the first and the last") {
  const Folder folder;
  Json study = small_study();
  study["axes"] = {{"/transfer/type", {"pic"}}};
  study["figures"] = {{{"type", "curves"}, {"column", "total energy"}, {"every", 10}}};
  write_inputs(folder, breathing(), study);
  const Result result = run_study(folder);
  INFO(result.err);
  REQUIRE(result.code == 0);
  const auto recorded = mpm::support::read_csv(folder / "out/runs/pic/metrics.csv");
  REQUIRE(recorded.rows() == 26);
  const auto &time = *recorded.find("time"), &energy = *recorded.find("total energy");
  std::istringstream csv(slurp(folder / "out/figures/curves.csv"));
  std::string line;
  std::getline(csv, line);
  for (const std::size_t row : {0, 10, 20, 25}) {
    REQUIRE(std::getline(csv, line));
    INFO(line);
    const auto at = line.find(",computed,") + 10, comma = line.find(',', at);
    CHECK(std::stod(line.substr(at)) == time[row]);
    CHECK(std::stod(line.substr(comma + 1)) == energy[row]);
  }
  CHECK(!std::getline(csv, line));
}
