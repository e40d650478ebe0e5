// What a run leaves behind, that it can be run again with the same bytes, and figures drawn again from it.

#include <cmath>
#include <sstream>
#include "cli/program.hpp"
#include "support/csv.hpp"
#include "support/processors.hpp"

namespace support = mpm::support;
using namespace mpm::test;

namespace {

std::vector<std::string> files_below(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder).string());
  std::sort(names.begin(), names.end());
  return names;
}

bool is_png(const fs::path& path) {
  return slurp(path).starts_with("\x89PNG\r\n");
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// The final numbers of a summary: all that the cadence of outputs must not change.
Json final_numbers(const fs::path& run) {
  const Json summary = json_in(run / "summary.json");
  Json numbers;
  for (const char* key : {"particles", "steps", "simulated_time", "time_step", "momentum", "centre_of_mass"})
    numbers[key] = summary[key];
  for (const auto& [kind, value] : summary["energy"].items())
    numbers[kind] = value.is_object() && value.contains("final") ? value["final"] : value;
  return numbers;
}

void run_as(const Folder& folder, const Json& scene, const std::string& name, const Words& more = {}) {
  spill(folder / (name + ".json"), scene.dump());
  Words words{"run", name + ".json", "--out", name};
  words.insert(words.end(), more.begin(), more.end());
  const Result result = call(folder, words);
  INFO(result.err);
  REQUIRE(result.code == 0);
}

/// Checks that `mpm figure` refuses bad input.
void figure_refused(const Folder& folder, const Words& words, const std::string& message) {
  const auto before = files_below(folder.path());
  const Result result = call(folder, words);
  INFO(result.err);
  INFO("expected: " << message);
  CHECK(result.code == 2);
  CHECK(has(result.err, message));
  CHECK(files_below(folder.path()) == before);
}

}  // namespace

TEST_CASE("the run folder holds what the contract says") {
  const Folder folder;
  Json scene = two_balls();
  scene["output"] = {{"metrics_every", 4}, {"frames", 3}, {"vtk", true}};
  scene["figures"] = {"energy", "contact"};
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  REQUIRE(result.code == 0);
  Words expected{"experiment.json", "manifest.json", "metrics.csv",      "plan.json",
                 "report.html",     "summary.json",  "vtk/particles.pvd"};
  for (const char* figure : {"energy", "contact", "contact_nodes"})
    for (const char* ending : {".png", ".svg", ".csv"}) expected.push_back(std::string("figures/") + figure + ending);
  for (const char* frame : {"frame_0000", "frame_0001", "frame_0002"})
    for (const char* ending : {".png", ".svg", ".csv"}) expected.push_back(std::string("frames/") + frame + ending);
  for (const char* number : {"0", "1", "2"}) expected.push_back(std::string("vtk/particles_000") + number + ".vtu");
  std::sort(expected.begin(), expected.end());
  const fs::path run = folder / "run";
  CHECK(files_below(run) == expected);
  for (const std::string& name : expected)
    if (name.ends_with(".png")) CHECK(is_png(run / name));

  const Json manifest = json_in(run / "manifest.json");
  for (const char* key : {"program", "version", "command", "experiment_sha256", "seed", "threads", "machine"})
    CHECK(manifest.contains(key));
  CHECK(manifest["command"] == "./mpm run scene.json --out run --threads 1");
  Words ids;
  for (const Json& plugin : manifest["plugins"]) {
    ids.push_back(plugin["id"]);
    CHECK(plugin["file_sha256"].get<std::string>().size() == 64);
  }
  std::sort(ids.begin(), ids.end());
  CHECK(ids == Words{"apic", "approach_and_position", "average_volume_gradient", "bspline_quadratic", "coulomb",
                     "neo_hookean"});

  const auto table = mpm::support::read_csv(run / "metrics.csv");
  CHECK(table.header.front() == "time (s)");
  CHECK(*table.find("step") == std::vector<double>{0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40});

  const Json summary = json_in(run / "summary.json");
  for (const char* group : {"energy", "momentum", "contact", "stability", "performance", "outcome"})
    CHECK(summary.contains(group));
  CHECK(summary["contact"]["most_nodes"].get<long>() > 0);

  const std::string report = slurp(run / "report.html");
  CHECK(count(report, "src=\"data:image/svg+xml;base64,") + count(report, "src=\"data:image/png;base64,") == 6);
  CHECK(has(report, "figures/contact_nodes.csv"));
  CHECK(!has(report, "src=\"http"));
  CHECK(!has(report, "<script src"));
}

TEST_CASE("the summary gives the sizes that momenta are held against, and the report folds what is rounding") {
  const Folder folder;
  Json scene = ball();
  scene["bodies"][0]["velocity"] = {0.3, 0.4};
  scene["figures"] = {"momentum", "energy"};
  REQUIRE(run_scene(folder, scene).code == 0);
  const Json summary = json_in(folder / "run/summary.json");
  // A ball of 20 kg/m at 0.5 m/s, as heavy as its particles: sum m |v| is the momentum itself. |x| is convex, so that
  // its mean over the ball is above that of the centre, which flies from (0.5, 0.5) to (0.53, 0.54).
  const double p = std::hypot(summary["momentum"]["linear"]["initial"]["x"].get<double>(),
                              summary["momentum"]["linear"]["initial"]["y"].get<double>());
  CHECK(summary["scales"]["momentum"].get<double>() == Approx(p).epsilon(1e-12));
  const double distance = summary["scales"]["angular_momentum"].get<double>() / p;
  CHECK(distance > std::hypot(0.53, 0.54));
  CHECK(distance < 1.03 * std::hypot(0.53, 0.54));
  const std::string report = slurp(folder / "run/report.html");
  CHECK(report.find("alt=\"energy\"") < report.find("alt=\"momentum\""));
  CHECK(!has(report, "<details><summary><b>momentum</b>"));
  CHECK(has(report, "<details><summary><b>angular momentum</b>: rounding"));
}

TEST_CASE("VTK's own reader reads what was written") {
  const Folder folder;
  const char* python = "/usr/bin/python3";
  if (!fs::exists(python) || Process(folder, {python, "-c", "import vtkmodules.vtkIOXML"}).finish().code != 0) {
    WARN("VTK for Python is not installed: its reader was not asked");
    return;
  }
  Json scene = ball();
  scene["output"] = {{"frames", 2}, {"vtk", true}};
  REQUIRE(run_scene(folder, scene).code == 0);
  spill(folder / "read.py", R"py(
import sys
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
for name in sys.argv[1:]:
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(name)
    reader.Update()
    grid = reader.GetOutput()
    data = grid.GetPointData()
    print(grid.GetNumberOfPoints(), *sorted(data.GetArrayName(k) for k in range(data.GetNumberOfArrays())), sep="|")
    velocity = data.GetArray("velocity (m/s)").GetTuple(0)
    print(all(abs(v - 0.1) < 1e-6 for v in velocity[:2]))
)py");
  const Result result =
      Process(folder, {python, "read.py", "run/vtk/particles_0000.vtu", "run/vtk/particles_0001.vtu"}).finish();
  INFO(result.out << result.err);
  CHECK(result.code == 0);
  CHECK(count(result.out, "52|body|pressure (Pa)|velocity (m/s)|volume_ratio|von_mises_stress (Pa)\nTrue") == 2);
}

TEST_CASE("experiment.json runs again and gives the same bytes") {
  const Folder folder;
  Json scene = two_balls();
  scene["solver"]["time_step"] = "auto";
  scene["bodies"][0]["jitter"] = 0.2;
  scene["gravity"] = {"0 m/s^2", "-9.81 m/s^2"};
  run_as(folder, scene, "first", {"--threads", "1", "--set", "/contact/friction=0.5", "--set", "/seed=7"});
  const Json resolved = json_in(folder / "first/experiment.json");
  CHECK(resolved["contact"]["friction"] == 0.5);
  CHECK(resolved["seed"] == 7);
  CHECK(resolved["gravity"][1] == -9.81);
  fs::copy_file(folder / "first/experiment.json", folder / "again.json");
  const Result again = call(folder, {"run", "again.json", "--out", "again", "--threads", "1"});
  INFO(again.err);
  REQUIRE(again.code == 0);
  CHECK(slurp(folder / "first/metrics.csv") == slurp(folder / "again/metrics.csv"));
  CHECK(json_in(folder / "again/experiment.json") == resolved);
}

TEST_CASE("the number of threads changes no bit") {
  const Folder folder;
  Json scene = two_balls();
  scene["output"]["metrics_every"] = 1;
  for (const char* precision : {"double", "float"}) {
    scene["precision"] = precision;
    const std::string one = std::string(precision) + "1", two = std::string(precision) + "2";
    run_as(folder, scene, one, {"--threads", "1"});
    run_as(folder, scene, two, {"--threads", "2"});
    CHECK(slurp(folder / one / "metrics.csv") == slurp(folder / two / "metrics.csv"));
    CHECK(final_numbers(folder / one) == final_numbers(folder / two));
    CHECK(json_in(folder / two / "manifest.json")["threads"] == std::min(2, mpm::support::available_processors()));
  }
}

TEST_CASE("the cadence of rows and frames changes no bit") {
  for (const char* backend : {"cpu", "reference"}) {
    INFO(backend);
    const Folder folder;
    Json scene = two_balls();
    scene["backend"] = backend;
    scene["grid"]["cell_size"] = 0.1;
    scene["solver"]["time_step"] = "auto";
    scene["output"] = {{"metrics_every", 1}};
    run_as(folder, scene, "one", {"--threads", "1"});
    scene["output"] = {{"metrics_every", 7}};
    run_as(folder, scene, "seven", {"--threads", "1"});
    scene["output"] = {{"metrics_every", 1000000}, {"frames", 2}};
    run_as(folder, scene, "frames", {"--threads", "1"});
    const Json numbers = final_numbers(folder / "one");
    CHECK(numbers.dump() == final_numbers(folder / "seven").dump());
    CHECK(numbers.dump() == final_numbers(folder / "frames").dump());
  }
}

TEST_CASE("--set and --backend change the run and are recorded") {
  const Folder folder;
  const Result result = run_scene(folder, ball(),
                                  {"--set", "/transfer/type=pic", "--set", "/solver/end_time=0.01", "--set",
                                   "/bodies/0/velocity=[1, 0]", "--backend", "reference"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  const Json resolved = json_in(folder / "run/experiment.json");
  CHECK(resolved["transfer"]["type"] == "pic");
  CHECK(resolved["backend"] == "reference");
  CHECK(json_in(folder / "run/summary.json")["steps"] == 5);
  CHECK(has(json_in(folder / "run/manifest.json")["command"], "--set '/bodies/0/velocity=[1, 0]'"));
}

TEST_CASE("the reference backend records the one thread that it runs on") {
  const Folder folder;
  run_as(folder, ball(), "run", {"--backend", "reference", "--threads", "2"});
  CHECK(json_in(folder / "run/manifest.json")["threads"] == 1);
}

TEST_CASE("a ledger of some steps says so, and warns where they are too few") {
  const Folder folder;
  Json scene = two_balls();
  scene["output"]["ledger_every"] = 10;
  run_as(folder, scene, "few", {"--backend", "reference"});
  Json summary = json_in(folder / "few/summary.json");
  REQUIRE(summary["steps"] < 95);
  CHECK(summary["energy"]["ledger_every"] == 10);
  const long steps = summary["steps"], entries = 1 + (steps - 1 + 4) / 10;
  CHECK(
      has(summary["warnings"].dump(), "the ledger is of " + std::to_string(entries) + " of " + std::to_string(steps) +
                                          " steps, too few to say where the energy went; lower /output/ledger_every"));
  CHECK(has(slurp(folder / "few/report.html"), "After the first step one in 10 is entered and counts for all of them"));
  CHECK(json_in(folder / "few/plan.json")["ledger_every"] == 10);

  scene["output"]["ledger_every"] = 1;
  run_as(folder, scene, "every", {"--backend", "reference"});
  summary = json_in(folder / "every/summary.json");
  CHECK(!summary["energy"].contains("ledger_every"));
  CHECK(!has(summary["warnings"].dump(), "the ledger is of"));
  CHECK(!has(slurp(folder / "every/report.html"), "After the first step one in"));
}

TEST_CASE("a run warns where mirror images make heat at a wall with convection") {
  const Folder folder;
  const auto warnings = [&](const std::string& transfer, double step) {
    const Json scene = Json::parse(R"J({"title": "slab", "dimension": 2,
      "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 0.3]], "boundaries": {"all": "slip",
        "x_min": {"type": "slip", "convection": {"coefficient": 10000, "temperature": 400}}}},
      "shape": {"type": "bspline_quadratic"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
        "thermal": {"conductivity": 1000, "heat_capacity": 100}}},
      "bodies": [{"name": "b", "material": "m", "temperature": 300, "frozen": true,
                  "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 0.3]}}],
      "output": {"frames": 0}})J");
    Json changed = scene;
    changed["transfer"] = {{"type", transfer}};
    changed["solver"] = {{"time_step", step}, {"end_time", 4}};
    const std::string name = transfer + std::to_string(step);
    run_as(folder, changed, name, {});
    return json_in(folder / name / "summary.json")["warnings"].dump();
  };
  CHECK(has(warnings("pic", 0.005), "mirror images gave heat of"));  // by PIC's own diffusion, through the wall too
  CHECK(!has(warnings("apic", 0.005), "mirror images"));
  CHECK(!has(warnings("flip", 0.005), "mirror images"));
}

TEST_CASE("a run with temperature records the heat, and others say nothing of it") {
  const Folder folder;
  Json scene = two_balls();
  scene["figures"] = {"heat"};
  spill(folder / "cold.json", scene.dump());
  const Result cold = call(folder, {"run", "cold.json", "--out", "cold", "--backend", "reference"});
  INFO(cold.err);
  CHECK(cold.code != 0);
  CHECK(has(cold.err,
            "figure \"heat\" needs \"heat ledger residual\", which the run does not record: give the materials "
            "\"thermal\" and set /output/ledger to true"));

  const Json boundaries = {{"all", "slip"}, {"y_min", {{"type", "slip"}, {"heat_flux", 100}}}};
  scene["grid"]["boundaries"] = boundaries;
  for (auto& [name, material] : scene["materials"].items())
    material["thermal"] = {
        {"conductivity", 10}, {"heat_capacity", 100}, {"phase_change", {{"temperature", 300}, {"latent_heat", 1000}}}};
  for (Json& body : scene["bodies"]) body["temperature"] = "299 + x";
  scene["output"]["frames"] = 2, scene["output"]["vtk"] = true, scene["output"]["colour_by"] = "temperature";
  run_as(folder, scene, "warm", {"--backend", "reference"});
  const Json heat = json_in(folder / "warm/summary.json")["heat"];
  CHECK(heat["ledger"].size() == 9);
  CHECK(std::abs(heat["ledger"]["residual"].get<double>()) < 1e-6);  // rounding of m c T, some 10^6 J
  CHECK(heat["lowest_temperature"] < heat["highest_temperature"]);
  CHECK(heat["latent"]["final"].is_number());
  const support::Table table = support::read_csv(folder / "warm/metrics.csv");
  for (const char* column :
       {"heat content", "latent heat", "lowest temperature", "highest temperature", "heat ledger scatter",
        "heat ledger images", "heat ledger gather", "heat ledger walls", "heat ledger flux", "heat ledger convection",
        "heat ledger boxes", "heat ledger dissipation", "heat ledger residual"})
    CHECK(table.find(column));
  for (const char* file : {"figures/heat.svg", "figures/heat_held.svg", "frames/frame_0000.png"})
    CHECK(fs::is_regular_file(folder / ("warm/" + std::string(file))));
  CHECK(has(slurp(folder / "warm/figures/heat.csv"), "residual"));
  CHECK(has(slurp(folder / "warm/vtk/particles_0000.vtu"), "temperature (K)"));

  scene["output"]["ledger"] = false;
  scene.erase("figures");
  run_as(folder, scene, "unaccounted", {"--backend", "reference"});
  CHECK_FALSE(json_in(folder / "unaccounted/summary.json")["heat"].contains("ledger"));
  CHECK_FALSE(has(slurp(folder / "unaccounted/metrics.csv"), "heat ledger"));
}

TEST_CASE("the areas of the heat figure sum to the heat gained, whatever the walls do with it") {
  const Folder folder;
  Json scene = ball();
  scene["transfer"] = {{"type", "apic"}};
  scene["materials"]["m"]["thermal"] = {{"conductivity", 100}, {"heat_capacity", 1000}};
  scene["bodies"][0]["geometry"] = {{"type", "box"}, {"lower", {0, 0}}, {"upper", {1, 0.5}}};
  scene["bodies"][0]["velocity"] = {0, 0};
  scene["bodies"][0]["temperature"] = "300 + 10*x";
  scene["figures"] = {"heat"};
  const Json convection = {{"coefficient", 1e4}, {"temperature", 400}};
  for (const auto& [key, value] :
       {std::pair<const char*, Json>{"convection", convection}, {"heat_flux", 1e5}, {"temperature", 350}}) {
    INFO(key);
    scene["grid"]["boundaries"] = {{"all", "slip"}, {"x_min", {{"type", "slip"}, {key, value}}}};
    run_as(folder, scene, key);
    const support::Table drawn = support::read_csv(folder / (std::string(key) + "/figures/heat.csv"));
    const support::Table measured = support::read_csv(folder / (std::string(key) + "/metrics.csv"));
    const auto& content = *measured.find("heat content");
    REQUIRE(drawn.rows() == content.size());
    const double gained = content.back() - content.front();
    double sum = 0, largest = 0;
    for (std::size_t k = 1; k < drawn.columns.size(); ++k) {
      sum += drawn.columns[k].back();
      largest = larger(largest, std::abs(drawn.columns[k].back()));
    }
    CHECK(std::abs(gained) > 10);
    CHECK(std::abs(sum - gained) < 1e-6 * largest);
  }
}

TEST_CASE("a filtered run records what the filter did, and others say nothing of it") {
  const Folder folder;
  Json scene = two_balls();
  scene["filter"] = {{"type", "fmpm"}, {"order", 3}};
  scene["figures"] = {"ledger", "dissipation"};
  run_as(folder, scene, "filtered", {"--backend", "reference"});
  const Json summary = json_in(folder / "filtered/summary.json");
  CHECK(summary["energy"]["ledger"]["filter"] != 0);
  const Json& filter = summary["stability"]["filter"];
  CHECK(filter["iterations"] == 2);
  CHECK(filter["increment_norm"] > 0);
  CHECK(filter["largest_growth"] > 0);
  // The loop contracts as long as no constraint acts on it; the warning says when one has broken that.
  CHECK((filter["largest_growth"] > 1 + 1e-9) == has(summary["warnings"].dump(), "its loop no longer contracts"));
  const support::Table table = support::read_csv(folder / "filtered/metrics.csv");
  for (const char* column : {"ledger filter", "filter increment norm", "filter iterations"}) CHECK(table.find(column));
  CHECK(has(slurp(folder / "filtered/figures/dissipation.csv"), "filter"));
  CHECK(has(slurp(folder / "filtered/figures/ledger.csv"), "filter"));

  scene.erase("filter");
  run_as(folder, scene, "plain", {"--backend", "reference"});
  const Json plain = json_in(folder / "plain/summary.json");
  CHECK(!plain["energy"]["ledger"].contains("filter"));
  CHECK(!plain["stability"].contains("filter"));
  CHECK(!has(slurp(folder / "plain/metrics.csv"), "filter"));
}

TEST_CASE("the program warns when friction stops a filter's loop from contracting") {
  // Contact makes of the loop's velocity u the grid's velocity F(u). Without friction F is the projection onto the
  // velocities that do not approach, in the mass norm: it lengthens no increment. Where bodies slide, what presses them
  // together by n brakes them by mu n as well: F may lengthen an increment to sqrt(1 + mu^2) of itself.
  const std::string words = "its loop no longer contracts";
  const Folder folder;
  Json scene = two_balls();
  scene["transfer"]["type"] = "pic";
  scene["filter"] = {{"type", "fmpm"}, {"order", 8}};
  scene["bodies"][0]["velocity"] = {3.0, -1.0};  // the bodies graze each other
  scene["bodies"][1]["velocity"] = {-3.0, 1.0};
  for (const char* backend : {"reference", "cpu"})
    for (const double friction : {0.0, 10.0}) {
      scene["contact"]["friction"] = friction;
      const Result result = run_scene(folder, scene, {"--backend", backend});
      INFO(backend << ", friction " << friction << "\n" << result.err);
      CHECK(result.code == 0);
      const Json summary = json_in(folder / "run/summary.json");
      CHECK(summary["energy"]["total"]["final_over_initial"] < 1);
      const double growth = summary["stability"]["filter"]["largest_growth"];
      if (friction > 0) CHECK(growth > 1.1);
      CHECK(growth <= std::sqrt(1 + friction * friction) + 1e-12);
      const std::size_t warnings = friction > 0 ? 2 : 1;
      REQUIRE(summary["warnings"].size() == warnings);
      CHECK(has(summary["warnings"][0], "the curved surface of body"));
      if (warnings == 2) CHECK(has(summary["warnings"][1], words));
      CHECK(has(result.err, "warning: the filter's increment grew") == (friction > 0));
      CHECK(has(slurp(folder / "run/report.html"), words) == (friction > 0));
    }
}

TEST_CASE("the program warns of curved bodies that met with coarse rims, and only of those") {
  const Folder folder;
  Json scene = two_balls();
  const std::string words = "is built of steps of 0.025 m, one particle's spacing";
  const Result met = run_scene(folder, scene);
  INFO(met.err);
  CHECK(met.code == 0);
  REQUIRE(json_in(folder / "run/summary.json")["contact"]["most_nodes"] > 0);
  CHECK(has(met.err, "warning: the curved surface of body"));
  CHECK(has(met.err, words));
  CHECK(has(slurp(folder / "run/report.html"), "is built of steps of 0.025 m"));
  for (const int body : {0, 1}) scene["bodies"][body]["velocity"] = {body - 0.5, body - 0.5};  // the balls fly apart
  const Result apart = run_scene(folder, scene);
  CHECK(apart.code == 0);
  REQUIRE(json_in(folder / "run/summary.json")["contact"]["most_nodes"] == 0);
  CHECK(!has(apart.err, "warning:"));
}

TEST_CASE("mpm figure draws one run again and lays several over one another") {
  const Folder folder;
  Json scene = ball();
  scene["figures"] = {"energy"};
  run_as(folder, scene, "a", {"--threads", "1"});
  scene["transfer"]["type"] = "pic";
  fs::create_directory(folder / "deep");
  run_as(folder, scene, "b", {"--threads", "1"});
  fs::rename(folder / "b", folder / "deep/a");

  const std::string before = slurp(folder / "a/figures/energy.csv");
  fs::remove_all(folder / "a/figures");
  const Result one = call(folder, {"figure", "a"});
  INFO(one.err);
  CHECK(one.code == 0);
  CHECK(slurp(folder / "a/figures/energy.csv") == before);
  CHECK(fs::exists(folder / "a/figures/momentum.png"));
  CHECK(!fs::exists(folder / "a/figures/contact.png"));
  CHECK(has(slurp(folder / "a/report.html"), "figures/momentum.csv"));

  const Result both = call(folder, {"figure", "a", "deep/a", "--out", "overlay"});
  INFO(both.err);
  CHECK(both.code == 0);
  CHECK(has(both.out, "figures in overlay"));
  CHECK(is_png(folder / "overlay/total_energy.png"));
  CHECK(!fs::exists(folder / "overlay/position_error_rms.png"));
  const std::string twin = slurp(folder / "overlay/total_energy.csv");
  INFO(twin.substr(0, 200));
  CHECK(has(twin, "work/a"));
  CHECK(has(twin, "deep/a"));

  spill(folder / "momentum.json", "{\"y\": \"momentum x\", // a comment\n \"labels\": [\"MLS\", \"PIC\"]}");
  const Result specified = call(folder, {"figure", "a", "deep/a", "--spec", "momentum.json", "--out", "overlay"});
  INFO(specified.err);
  CHECK(specified.code == 0);
  CHECK(is_png(folder / "overlay/momentum.png"));
  CHECK(has(slurp(folder / "overlay/momentum.csv"), "PIC"));

  const auto specification_refused = [&](const std::string& text, const std::string& message) {
    spill(folder / "spec.json", text);
    figure_refused(folder, {"figure", "a", "deep/a", "--spec", "spec.json", "--out", "nowhere"}, message);
  };
  specification_refused("{\"y\": \"momentum x\",\n  \"logx\": true}", "spec.json:2:3: /logx: unknown key");
  specification_refused("{\"y\": \"momentum x\",\n  \"logx\": true}", "did you mean \"log_x\"?");
  specification_refused("{\"y\": \"total enegry\"}", "spec.json:1:7: /y: run ");
  specification_refused("{\"y\": \"total enegry\"}", "has no column \"total enegry\"; did you mean \"total energy\"?");
  specification_refused("{\"x\": \"time\"}", "/y: missing key");
  specification_refused("{\"y\": \"momentum x\", \"linear_within\": 1}", "/linear_within: belongs to \"log_y\": true");
  specification_refused("{\"y\": \"momentum x\", \"marks\": {\"at\": 1}}", "/marks: expected a list of places");
  specification_refused("{\"y\": \"momentum x\", \"marks\": [{\"at\": 1}]}", "/marks/0/label: missing key");
  specification_refused("{\"y\": \"momentum x\", \"marks\": [{\"at\": 1, \"label\": \"\"}]}", "the name is empty");
  specification_refused("{\"y\": 3}", "spec.json:1:7: /y: expected ");
  specification_refused("{\"y\": \"momentum x\", \"labels\": [\"one\"]}", "1 labels for 2 runs; give one a run");
  specification_refused("{\"y\" \"momentum x\"}", "spec.json:1:6: ");
  specification_refused("[]", "spec.json:1:1: ");
  figure_refused(folder, {"figure", "a", "--spec", "missing.json"},
                 "missing.json: there is no such file\nnothing was drawn");
  figure_refused(folder, {"figure", "a", "--out", "spec.json"}, "spec.json: is a file; choose a folder with --out");
}

TEST_CASE("mpm figure says what is no run") {
  const Folder folder;
  fs::create_directories(folder / "empty");
  figure_refused(folder, {"figure", "missing"}, "missing holds no run (no manifest.json)");
  figure_refused(folder, {"figure", "empty"}, "empty holds no run (no manifest.json)");
  figure_refused(folder, {"figure"}, "RUN");
  spill(folder / "empty/manifest.json", "{}");
  figure_refused(folder, {"figure", "empty"}, "empty: holds no metrics.csv: the run ended before its first row");
  spill(folder / "empty/metrics.csv", "time (s),step\n");
  figure_refused(folder, {"figure", "empty"}, "metrics.csv: holds no row");
  spill(folder / "empty/metrics.csv", "time (s),step\n0,0\n1,x\n");
  figure_refused(folder, {"figure", "empty"}, "its numbers cannot be read: ");
}

TEST_CASE("a frame shows the domains of particles that carry them") {
  const Folder folder;
  Json scene = ball();
  scene["shape"]["type"] = "cpdi";
  scene["output"]["frames"] = 1;
  spill(folder / "scene.json", scene.dump());
  const Result result = call(folder, {"run", "scene.json", "--out", "run"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  const std::string table = slurp(folder / "run/frames/frame_0000.csv");
  CHECK(has(table, "semi-side 1 x (m),semi-side 1 y (m),semi-side 2 x (m),semi-side 2 y (m)"));
  // Boxes are undeformed: half a particle's side along x, nothing along y, then the other way round.
  const std::string half = table.substr(table.find('\n') + 1);
  std::vector<double> numbers;
  std::istringstream row(half.substr(0, half.find('\n')));
  for (std::string cell; std::getline(row, cell, ',');) numbers.push_back(std::stod(cell));
  REQUIRE(numbers.size() == 8);
  CHECK(numbers[3] == Approx(numbers[2]).epsilon(1e-6));
  CHECK(numbers[4] == 0);
  CHECK(numbers[5] == 0);
  CHECK(numbers[6] == Approx(numbers[2]).epsilon(1e-6));
}

TEST_CASE("a run that begins without energy says what it ends with") {
  const Folder folder;
  Json scene = ball();
  scene["bodies"][0]["velocity"] = {0, 0};
  scene["gravity"] = {0, -1};
  spill(folder / "scene.json", scene.dump());
  CHECK(has(call(folder, {"run", "scene.json", "--out", "falls"}).out, "total energy final/initial "));
  scene.erase("gravity");
  spill(folder / "scene.json", scene.dump());
  CHECK(has(call(folder, {"run", "scene.json", "--out", "rests"}).out,
            "total energy 0 J/m at the end, none at the start"));
}
