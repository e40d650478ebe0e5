// The shipped studies of extremes load; and what a run does that is not as it should be is named, in the summary, in
// the report and by the exit code.

#include "cli/program.hpp"
#include "experiment/diagnostics.hpp"
#include "solvers/solver.hpp"
#include "study/study.hpp"
#include "support/scene.hpp"

using namespace mpm::test;

namespace {

std::vector<fs::path> shipped_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(MPM_SOURCE_DIR) / "experiments/extremes"))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Whether a file is a study: scenes that studies change have no axes.
bool is_study(const fs::path& file) {
  return !file.stem().string().ends_with("_scene");
}

/// The one mix in the studies of every shape and transfer that does not run, as docs/combinations.md names it.
const std::string polypic_without_axes = "carries products of polynomials along the axes";

bool is_without_axes(const mpm::study::Combination& combination) {
  return has(combination.name, "cpdi") && has(combination.name, "PolyPIC");
}

mpm::ReadOptions options(std::vector<std::string> overrides = {}) {
  mpm::ReadOptions options;
  options.solvers = mpm::solver_descriptions();
  options.exact = mpm::exact_solutions();
  options.overrides = std::move(overrides);
  return options;
}

/// Why a combination cannot be run: "" when it can, `polypic_without_axes` for that reason, else all that is wrong.
std::string refusal(const mpm::study::Study& study, const mpm::study::Combination& combination) {
  std::vector<std::string> overrides = combination.overrides;
  if (const auto& b = study.bisection) overrides.push_back(b->pointer + "=" + Json(b->from * b->scale).dump());
  try {
    mpm::make_plan(mpm::read_experiment(study.base, plugins(), options(overrides)));
    return "";
  } catch (const mpm::InputError& error) {
    return has(error.what(), polypic_without_axes) ? polypic_without_axes : error.what();
  }
}

/// The ball of `ball()` with a velocity that squeezes it.
Json squeezed() {
  Json scene = ball();
  scene["bodies"][0]["velocity"] = {"-2*(x-0.5)", "-2*(y-0.5)"};
  scene["solver"] = {{"time_step", 0.01}, {"end_time", 0.5}};
  scene["output"] = {{"metrics_every", 1}};
  return scene;
}

/// A scene that gains: linear shapes with FLIP in a collision gain energy long before they invert.
Json gaining() {
  Json scene = two_balls();
  scene.erase("contact");
  scene["shape"]["type"] = "linear";
  scene["transfer"]["type"] = "flip";
  scene["bodies"][0]["velocity"] = {0.3, 0.3};
  scene["bodies"][1]["velocity"] = {-0.3, -0.3};
  scene["solver"] = {{"time_step", 0.01}, {"end_time", 0.6}};
  scene["output"] = {{"metrics_every", 1}};
  return scene;
}

/// Runs a study of one run, in `folder`/out.
Result run_as_study(const Folder& folder, const Json& scene, const Json& limits) {
  spill(folder / "scene.json", scene.dump(1));
  const std::string transfer = scene["transfer"]["type"];
  const Json study{{"base", "scene.json"}, {"axes", {{"/transfer/type", {transfer}}}}, {"limits", limits}};
  spill(folder / "s.json", study.dump(1));
  return call(folder, {"study", "s.json", "--out", "out", "--jobs", "1"});
}

/// Checks that the study names what the run did: on standard error, in study.json and in its report, with code 4.
void is_flagged(const Json& scene, const Json& limits, const std::string& name) {
  const Folder folder;
  const Result result = run_as_study(folder, scene, limits);
  INFO(result.err);
  CHECK(result.code == 4);
  CHECK(has(result.err, name));
  const Json study = json_in(folder / "out/study.json");
  REQUIRE(study["runs"].size() == 1);
  CHECK(study["runs"][0]["status"] == "done");
  REQUIRE(study["objections"].size() == 1);
  CHECK(has(study["objections"][0], name));
  CHECK(has(slurp(folder / "out/report.html"), name));
}

/// Checks that the run alone names the metric in its summary's outcome, with code 4.
void fails_expectation(const Json& scene, const Json& expectation) {
  const Folder folder;
  const Result result = run_scene(folder, expecting(scene, expectation));
  INFO(result.err);
  CHECK(result.code == 4);
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["outcome"]["exit_code"] == 4);
  CHECK(has(summary["outcome"]["reason"], expectation["metric"].get<std::string>()));
  CHECK(has(slurp(folder / "run/report.html"), expectation["metric"].get<std::string>()));
}

/// Checks that the run alone gives code 4, and the flag in its summary, in its report and on standard error.
void flags_itself(const Json& scene, const std::string& name) {
  const Folder folder;
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  CHECK(result.code == 4);
  CHECK(has(result.err, "flagged: " + name));
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["outcome"]["exit_code"] == 4);
  CHECK(summary["outcome"]["status"] == "limit broken");
  CHECK(has(summary["outcome"]["reason"], name));
  REQUIRE(summary["flags"].size() == 1);
  CHECK(has(summary["flags"][0], name));
  const std::string report = slurp(folder / "run/report.html");
  CHECK(has(report, "Finished, but broke a limit (exit code 4)"));
  CHECK(has(report, name));
  CHECK(fs::is_regular_file(folder / "run/metrics.csv"));
}

/// Checks for code 3 that the summary's outcome names the cause, and standard error the remedy that fits it.
void stops(const Json& scene, const std::string& cause, const std::string& remedy) {
  const Folder folder;
  const auto [reason, err] = stopped_scene(folder, scene);
  INFO(err);
  CHECK(has(reason, cause));
  CHECK(has(slurp(folder / "run/report.html"), cause));
  const auto place = err.find("remedy: ");
  REQUIRE(place != std::string::npos);
  CHECK(has(err.substr(place, err.find('\n', place) - place), remedy));
}

}  // namespace

TEST_CASE("every shipped study of extremes loads, and so does every combination of it") {
  std::size_t studies = 0;
  for (const fs::path& file : shipped_files()) {
    INFO(file);
    if (!is_study(file)) {
      CHECK_NOTHROW(mpm::read_experiment(file, plugins(), options()));
      continue;
    }
    ++studies;
    const mpm::study::Study study = mpm::study::read_study(file);
    CHECK(!study.figures.empty());
    for (const mpm::study::Combination& combination : mpm::study::expand(study)) {
      INFO(combination.name);
      CHECK(refusal(study, combination) == (is_without_axes(combination) ? polypic_without_axes : ""));
    }
  }
  CHECK(studies == 21);
}

TEST_CASE("a gain of energy is named, by the run and by its study") {
  flags_itself(gaining(), "energy gain of ");
  is_flagged(gaining(), {{"isolated", true}}, "energy gain of ");
  fails_expectation(gaining(), {{"metric", "energy.total.largest_over_initial"}, {"at_most", 1.01}});
  Json meant = gaining();
  meant["limits"] = {{"energy_gain", nullptr}};
  const Folder folder;
  const Result result = run_scene(folder, meant);
  CHECK(result.code == 0);
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["flags"].empty());
  CHECK(summary["limits"][0]["not_judged"] == "no limit is asked for");
  CHECK(summary["energy"]["total"]["gain"] > 0.01);
  CHECK(!has(result.err, "flagged"));
}

TEST_CASE("the gain of a scene that is driven is not judged, and the summary says why") {
  Json scene = gaining();
  scene["body_force"] = {"0*t", 0};
  const Folder folder;
  CHECK(run_scene(folder, scene).code == 0);
  CHECK(json_in(folder / "run/summary.json")["limits"][0]["not_judged"] == "/body_force works on the scene");
  const std::string report = slurp(folder / "run/report.html");
  CHECK(has(report, "at most 0.01; /body_force works on the scene"));
  CHECK(has(report, "<td>no limit is asked for</td>"));
  scene["limits"] = {{"isolated", true}};
  flags_itself(scene, "energy gain of ");
}

TEST_CASE("a volume ratio out of range is named") {
  is_flagged(squeezed(), {{"volume_ratio", {0.9, 2}}, {"energy_gain", nullptr}}, "smallest volume ratio J 0.");
  Json swollen = squeezed();
  swollen["bodies"][0]["velocity"] = {"2*(x-0.5)", "2*(y-0.5)"};
  is_flagged(swollen, {{"volume_ratio", {0.1, 1.1}}, {"energy_gain", nullptr}}, "largest volume ratio J 1.");
  fails_expectation(squeezed(), {{"metric", "stability.smallest_volume_ratio"}, {"at_least", 0.9}});
  swollen["limits"] = {{"volume_ratio", {0.1, 1.1}}, {"energy_gain", nullptr}};
  flags_itself(swollen, "largest volume ratio J 1.");
}

TEST_CASE("the gain of a body that falls counts against what the domain lets it fall, wherever the origin is") {
  Json scene = ball();
  scene["bodies"][0]["velocity"] = {0, 0};
  scene["gravity"] = {4, -10};
  scene["body_force"] = {0, 30};  // makes a gain
  scene["grid"]["domain"] = {{0, 1000}, {1, 1001}};
  scene["bodies"][0]["geometry"]["centre"] = {0.4, 1000.3};
  const Folder folder;
  CHECK(run_scene(folder, scene).code == 0);
  const Json energy = json_in(folder / "run/summary.json")["energy"];
  const double initial = energy["total"]["initial"], rise = energy["total"]["largest"].get<double>() - initial;
  const double gain = energy["total"]["gain"];
  // It may fall by 0.3 m in y and by 0.6 m in x, of an energy m (10 y - 4 x) at (0.4, 1000.3) m.
  CHECK(gain > 0.01);
  CHECK(gain == Approx(rise / (initial * (10 * 0.3 + 4 * 0.6) / (10 * 1000.3 - 4 * 0.4))).epsilon(1e-6));
}

TEST_CASE("a formula stands in every panel of small multiples, over the numbers of their axis") {
  const Folder folder;
  Json scene = ball();
  scene["solver"]["end_time"] = 0.01;
  spill(folder / "scene.json", scene.dump(1));
  spill(folder / "s.json", R"J({"base": "scene.json",
    "axes": {"/transfer/type": ["pic", "flip"], "/solver/time_step": [0.001, 0.002]},
    "measure": {"steps": {"value": "/steps", "label": "steps"}},
    "figures": [{"type": "small_multiples", "x": "/solver/time_step", "panels": "/transfer/type", "value": "steps",
                 "exact": "0.01/x", "exact_label": "end over step"}]})J");
  const Result result = call(folder, {"study", "s.json", "--out", "out", "--jobs", "1"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  const std::string csv = slurp(folder / "out/figures/small_multiples.csv");
  INFO(csv);
  CHECK(has(csv, "end over step"));
  CHECK(has(csv, "exact,0.001,10"));
  CHECK(has(csv, "exact,0.002,5"));
  CHECK(has(csv, "computed,0.002,5"));
}

TEST_CASE("a run that stops says why, and what helps against that") {
  Json scene = ball();
  scene["solver"] = {{"time_step", 0.5}, {"end_time", 50}};
  stops(scene, "inverted: its volume ratio J is not positive", "a transfer with more damping");

  scene = ball();
  scene["body_force"] = {"sqrt(0.05 - t)", 0};
  stops(scene, "not a number", "check that expression");

  scene = ball();
  scene["grid"]["boundaries"]["all"] = "free";
  scene["bodies"][0]["velocity"] = {20, 0};
  stops(scene, "left the domain", "a larger /grid/domain");

  // The two cases are a box that is drawn to more than two cells, and a list that reaches beyond the padding.
  scene = ball();
  scene["shape"]["type"] = "gimp_contiguous";
  scene["transfer"]["type"] = "tpic";
  scene["grid"]["domain"] = {{0, 0}, {6, 1}};
  scene["grid"]["boundaries"]["all"] = "free";
  scene["materials"]["m"]["youngs_modulus"] = 1e-6;
  scene["bodies"][0]["geometry"]["centre"] = {3, 0.5};
  scene["bodies"][0]["velocity"] = {"2*(x-3)", 0};
  scene["solver"] = {{"time_step", 0.01}, {"end_time", 5}};
  stops(scene, "its domain has grown too long for the 4 nodes", "/shape/type \"cpdi\"");

  scene = Json::parse(R"J({
    "title": "sheared", "dimension": 2,
    "grid": {"cell_size": 1, "domain": [[0, 0], [60, 4]], "boundaries": {"all": "free"}},
    "shape": {"type": "cpdi"}, "transfer": {"type": "tpic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}},
    "bodies": [{"name": "cell", "material": "m", "geometry": {"type": "box", "lower": [1, 1], "upper": [2, 2]}, "velocity": ["80*(y-1.25)", 0]}],
    "solver": {"time_step": 1, "end_time": 10}})J");
  stops(scene, "its domain reaches more than 8 cells", "more particles a cell");
}
