// Exit codes 3, 5 and 130, and a kill without warning: what the run folder then holds.

#include <sys/mount.h>

#include "cli/program.hpp"
#include "support/csv.hpp"

using namespace mpm::test;

namespace {

/// Checks that every file is whole: JSON parses, rows of metrics.csv are complete, nothing temporary carries a result's
/// name.
void check_whole(const fs::path& run) {
  for (const auto& entry : fs::recursive_directory_iterator(run)) {
    const std::string name = entry.path().filename().string();
    INFO(entry.path());
    if (name.starts_with('.')) {
      CHECK(name.ends_with(".tmp"));
      continue;
    }
    CHECK(!name.ends_with(".tmp"));
    if (entry.path().extension() == ".json") json_in(entry.path());
  }
  if (!fs::exists(run / "metrics.csv")) return;
  const auto table = mpm::support::read_csv(run / "metrics.csv");
  CHECK(table.columns.size() > 10);
}

/// Checks that a scene gives code 3, that the message holds all parts, and that the rows before are there.
void fails(const Json& scene, const Words& parts) {
  const Folder folder;
  const auto [reason, err] = stopped_scene(folder, scene);
  INFO(err);
  for (const std::string& part : parts) {
    INFO(part);
    CHECK(has(reason, part));
  }
  CHECK(mpm::support::read_csv(folder / "run/metrics.csv").rows() >= 1);
  check_whole(folder / "run");
}

struct SmallDisk {
  explicit SmallDisk(fs::path at) : path(std::move(at)) {
    fs::create_directory(path);
    mounted = ::mount("tmpfs", path.c_str(), "tmpfs", 0, "size=96k") == 0;
  }
  ~SmallDisk() {
    if (mounted) ::umount2(path.c_str(), MNT_DETACH);
  }
  fs::path path;
  bool mounted = false;
};

void interrupt_with(int signal) {
  const Folder folder;
  Json scene = endless_ball();
  scene["figures"] = {"energy"};
  spill(folder / "scene.json", scene.dump());
  Process process(folder, program({"run", "scene.json", "--out", "run", "--threads", "1"}));
  REQUIRE(process.wait_until([&] { return rows_written(folder / "run/metrics.csv", 20); }));
  process.send(signal);
  const Result result = process.finish();
  INFO(result.err);
  CHECK(result.code == 130);
  CHECK(has(result.err, "stopped by a signal after step"));
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["outcome"]["exit_code"] == 130);
  CHECK(summary["outcome"]["status"] == "interrupted");
  const auto table = mpm::support::read_csv(folder / "run/metrics.csv");
  CHECK(!table.last_line_was_cut);
  CHECK(table.find("step")->back() == summary["steps"].get<double>());
  CHECK(table.find("time")->back() == summary["simulated_time"].get<double>());
  CHECK(table.find("total energy")->back() == summary["energy"]["total"]["final"].get<double>());
  CHECK(fs::exists(folder / "run/figures/energy.png"));
  CHECK(has(slurp(folder / "run/report.html"), "nterrupted"));
  check_whole(folder / "run");
}

}  // namespace

TEST_CASE("3: an inverted particle") {
  Json scene = ball();
  scene["solver"] = {{"time_step", 0.5}, {"end_time", 50}};
  for (const char* backend : {"cpu", "reference"}) {
    scene["backend"] = backend;
    fails(scene, {"step ", "t = ", "particle ", "of body \"ball\" at (", ") m ", "inverted"});
  }
}

// The particle that inverts takes part in the step's ledger and strain before anyone looks at it. What the last rows of the
// run hold is told, and no sum with a part of the step that failed.
TEST_CASE("3: no loss and no ledger are told of a step that failed on its way") {
  const Folder folder;
  const std::string lesson = (fs::path(MPM_SOURCE_DIR) / "experiments/lessons/spinning_disc_apic.json").string();
  const Result result =
      call(folder, {"run", lesson, "--set", "/shape/type=linear", "--set", "/figures=[]", "--set", "/output/frames=0",
                    "--set", R"(/limits={"unexplained_loss": 0.1})", "--out", "run"});
  INFO(result.err);
  REQUIRE(result.code == 3);
  CHECK(has(result.err, "inverted"));
  CHECK_FALSE(has(result.err, "of the energy"));
  const Json summary = json_in(folder / "run/summary.json"), &energy = summary["energy"];
  CHECK(std::abs(energy["total"]["final_over_initial"].get<double>() - 1) < 0.01);  // of the rows that are whole
  for (const char* part : {"ledger", "books"}) CHECK_FALSE(energy.contains(part));
  for (const char* loss : {"numerical_loss", "unexplained_loss"}) CHECK_FALSE(energy["total"].contains(loss));
  CHECK(summary["flags"].empty());
  bool found = false;
  for (const Json& limit : summary["limits"])
    if (limit["metric"] == "energy.total.unexplained_loss")
      found = limit["not_judged"] == "not recorded: the last step failed";
  CHECK(found);
}

TEST_CASE("3: a particle that leaves the domain") {
  Json scene = ball();
  scene["grid"]["boundaries"]["all"] = "free";
  scene["bodies"][0]["velocity"] = {20, 0};
  for (const char* backend : {"cpu", "reference"}) {
    scene["backend"] = backend;
    fails(scene, {"step ", "particle ", "of body \"ball\" at (", "domain"});
  }
}

TEST_CASE("3: a force that is no number, in the very first step and later") {
  struct Case {
    const char *force, *step, *why;
  };
  // The ball's first particle is the lowest one, and in its row the leftmost.
  const Case cases[] = {
      {"sqrt(x - 10)", "step 1, t = 0 s: particle 0 of body \"ball\" at (",
       "\"sqrt(x - 10)\" at character 1 is sqrt(-9."},
      {"1 + 2*log(0.049 - t)", "step 26, t = 0.05 s: particle 0 of body \"ball\" at (",
       "\"log(0.049 - t)\" at character 7 is log(-0.001"},
      {"1/(X - X)", "step 1, t = 0 s: particle 0 of body", "\"1/(X - X)\" at character 1 is 1 / 0"},
      {"x > 0 ? t/(t - t) : log(x)", "step 1, t = 0 s: particle 0 of body", "\"t/(t - t)\" at character 9 is 0 / 0"}};
  for (const char* backend : {"cpu", "reference"})
    for (const Case& c : cases)
      for (const bool of_body : {false, true}) {
        Json scene = ball();
        scene["backend"] = backend;
        if (of_body)
          scene["loads"] = {{{"type", "body_force"}, {"body", "ball"}, {"acceleration", {0, c.force}}}};
        else
          scene["body_force"] = {0, c.force};
        INFO(backend << " " << c.force);
        const std::string place = of_body ? ": /loads/0/acceleration/1" : ": /body_force/1";
        fails(scene, {c.step, ") m not a number: ", ".json:", place + ": is not a finite number at t = ", c.why});
      }
}

TEST_CASE("3: a load at points that is no number") {
  const Json everywhere{{"type", "half_space"}, {"point", {0, 0}}, {"normal", {0, -1}}};
  const std::pair<Json, std::string> cases[] = {
      {{{"type", "traction"}, {"where", everywhere}, {"traction", {"log(-X)", 0}}}, "/loads/1/traction/0"},
      {{{"type", "pressure"}, {"where", everywhere}, {"pressure", "1/(x - x)"}}, "/loads/1/pressure"},
      {{{"type", "force"}, {"at", {0.5, 0.5}}, {"force", {0, "sqrt(-1 - t)"}}}, "/loads/1/force/1"}};
  for (const char* backend : {"cpu", "reference"})
    for (auto [load, place] : cases) {
      Json scene = ball();
      scene["backend"] = backend;
      load["body"] = "ball";
      scene["loads"] = {{{"type", "body_force"}, {"body", "ball"}, {"acceleration", {0, "t"}}}, load};
      INFO(backend << " " << place);
      fails(scene, {"step 1, t = 0 s: particle ",
                    ") m not a number: ", ": " + place + ": is not a finite number at t = 0 s: \""});
    }
}

TEST_CASE("3: a temperature that grows beyond all numbers") {
  Json scene = warm_ball("300 + 10*x");
  scene["materials"]["m"]["thermal"]["conductivity"] = 1e14;
  for (const char* backend : {"cpu", "reference"}) {
    scene["backend"] = backend;
    fails(scene, {"particle ", "of body \"ball\" at (", ") m not a number: its temperature is no longer finite"});
  }
}

TEST_CASE("3: walls and boxes that impose what nothing can have, named with the time") {
  const std::string zero = ": is -0.1 K, below 0 K, at t = 0.052 s, ",
                    none = ": is not a finite number at t = 0.052 s, ", why = " at character 1 is ";
  const auto wall = [](const char* name, const Json& value) {
    Json scene = warm_ball();
    scene["grid"]["boundaries"]["x_min"] = {{"type", "slip"}, {name, value}};
    return scene;
  };
  const auto box = [](const char* name, const char* value) {
    Json scene = warm_ball();
    scene["node_conditions"] = {{{"type", "thermal"}, {"lower", {0.4, 0.4}}, {"upper", {0.6, 0.6}}, {name, value}}};
    return scene;
  };
  const Json beyond{{"coefficient", 2}, {"temperature", "50*(0.05-t)"}};
  const std::vector<std::pair<Json, std::string>> scenes{
      {wall("temperature", "50*(0.05-t)"), "/grid/boundaries/x_min/temperature" + zero + "(0, 0) m"},
      {wall("temperature", "sqrt(0.051-t)*300"),
       "/grid/boundaries/x_min/temperature" + none + "(0, 0) m: \"sqrt(0.051-t)\"" + why + "sqrt(-0.001)"},
      {wall("heat_flux", "log(0.051-t)"),
       "/grid/boundaries/x_min/heat_flux" + none + "(0, 0) m: \"log(0.051-t)\"" + why + "log(-0.001)"},
      {wall("convection", beyond), "/grid/boundaries/x_min/convection/temperature" + zero + "(0, 0) m"},
      {box("temperature", "50*(0.05-t)"), "/node_conditions/0/temperature" + zero + "(0.4, 0.4) m"},
      {box("heating", "log(0.051-t)"),
       "/node_conditions/0/heating" + none + "(0.4, 0.4) m: \"log(0.051-t)\"" + why + "log(-0.001)"}};
  for (const auto& [scene, reason] : scenes) {
    const Folder folder;
    const Result result = run_scene(folder, scene);
    INFO(reason << "\n" << result.err);
    CHECK(result.code == 3);
    CHECK(has(result.err, "the run failed: step 26: scene.json:"));
    CHECK(has(result.err, ": " + reason + "\nremedy: check that expression"));
    const Json outcome = json_in(folder / "run/summary.json")["outcome"];
    CHECK(outcome["cause"] == "impossible value imposed");
    CHECK(outcome["where"]["step"] == 26);
    CHECK(has(reason, outcome["where"]["condition"].get<std::string>() + ": is "));
    CHECK(mpm::support::read_csv(folder / "run/metrics.csv").find("step")->back() == 25);
    check_whole(folder / "run");
  }
}

TEST_CASE(
    "3: walls, boxes, grips and gravity without a finite number are named with line, component, time and operation") {
  const auto in_space = [](Json scene, int D) {
    if (D == 2) return scene;
    scene["dimension"] = 3;
    scene["grid"]["domain"] = {{0, 0, 0}, {1, 1, 1}};
    scene["bodies"][0]["geometry"]["centre"] = {0.5, 0.5, 0.5};
    scene["bodies"][0]["velocity"] = {0.1, 0.1, 0};
    return scene;
  };
  const std::string root = "sqrt(0.051-t)", at = ": is not a finite number at t = 0.052 s",
                    why = ": \"sqrt(0.051-t)\" at character 1 is sqrt(-0.001";
  for (const int D : {2, 3}) {
    const auto velocity = [&](const Json& x, const Json& y) { return D == 2 ? Json{x, y} : Json{x, y, 0}; };
    const auto corner = [&](double x) { return Json(std::vector<double>(static_cast<std::size_t>(D), x)); };
    const std::string z = D == 2 ? ") m" : ", 0) m";
    Json wall = in_space(ball(), D), box = wall, grip = wall, pull = wall;
    wall["grid"]["boundaries"]["x_min"] = {{"type", "prescribed"}, {"velocity", velocity(root, 0)}};
    box["node_conditions"] = {{{"type", "prescribed"},
                               {"lower", corner(0.4)},
                               {"upper", corner(0.6)},
                               {"velocity", velocity(nullptr, root + " + 0*x")}}};
    grip["grips"] = {{{"body", "ball"},
                      {"where", {{"type", "box"}, {"lower", corner(0.4)}, {"upper", corner(0.6)}}},
                      {"velocity", velocity(nullptr, root)}}};
    pull["gravity"] = velocity(0, root);
    struct Case {
      const Json& scene;
      std::string pointer, place;
    };
    for (const char* backend : {"cpu", "reference"})
      for (const auto& [scene, pointer, place] :
           {Case{wall, "/grid/boundaries/x_min/velocity/0", ", (0, 0" + z},
            Case{box, "/node_conditions/0/velocity/1", D == 2 ? ", (0.4, 0.4) m" : ", (0.4, 0.4, 0.4) m"},
            Case{grip, "/grips/0/velocity/1", ", (0.4"}, Case{pull, "/gravity/1", ""}}) {
        INFO(D << " " << backend << " " << pointer);
        const Folder folder;
        const Result result = run_scene(folder, scene, {"--backend", backend});
        INFO(result.err);
        CHECK(result.code == 3);
        const std::size_t first = result.err.find("the run failed: ");
        REQUIRE(first != std::string::npos);
        const std::string line = result.err.substr(first, result.err.find('\n', first) - first);
        const int step = pointer == "/gravity/1" ? 27 : 26;  // forces are those of the step's begin
        int row = 0, column = 0;
        CHECK(std::sscanf(line.c_str(),
                          ("the run failed: step " + std::to_string(step) + ": scene.json:%d:%d: ").c_str(), &row,
                          &column) == 2);
        CHECK(row > 1);
        CHECK(has(line, ": " + pointer + at + place));
        CHECK(has(line, why));
        const Json where = json_in(folder / "run/summary.json")["outcome"]["where"];
        CHECK(where["condition"] == pointer);
        if (where.contains("position")) CHECK(where["position"].size() == static_cast<std::size_t>(D));
        check_whole(folder / "run");
      }
  }
}

TEST_CASE("3: max_steps before the end") {
  const Folder folder;
  Json scene = ball();
  scene["solver"]["max_steps"] = 7;
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  CHECK(result.code == 3);
  CHECK(has(result.err, "max_steps (7) was reached before end_time"));
  CHECK(mpm::support::read_csv(folder / "run/metrics.csv").find("step")->back() == 7);
}

TEST_CASE("5: the disk fills up") {
  const Folder folder;
  const SmallDisk disk(folder / "disk");
  if (!disk.mounted) {
    WARN("no small disk could be mounted: the test of a full one is left out");
    return;
  }
  spill(folder / "scene.json", endless_ball().dump());
  const Result result = call(folder, {"run", "scene.json", "--out", "disk/run", "--threads", "1"});
  INFO(result.err);
  CHECK(result.code == 5);
  CHECK(has(result.err, "metrics.csv: No space left on device; free some space there"));
  const auto table = mpm::support::read_csv(disk.path / "run/metrics.csv");
  CHECK(!table.last_line_was_cut);
  CHECK(table.rows() > 10);
  check_whole(disk.path / "run");
}

TEST_CASE("5: a file grows beyond its limit; summary and report still say what was reached") {
  const Folder folder;
  spill(folder / "scene.json", endless_ball().dump());
  const std::string command =
      "ulimit -f 256; exec '" MPM_BUILD_DIR "/bin/mpm' run scene.json --out run --threads 1";  // of 512 bytes
  const Result result = Process(folder, {"/bin/sh", "-c", command}).finish();
  INFO(result.err);
  CHECK(result.code == 5);
  CHECK(has(result.err, "metrics.csv: File too large; raise the limit on file size"));
  const auto table = mpm::support::read_csv(folder / "run/metrics.csv");
  CHECK(!table.last_line_was_cut);
  CHECK(table.rows() > 100);
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["outcome"]["exit_code"] == 5);
  CHECK(has(slurp(folder / "run/report.html"), "File too large"));
  check_whole(folder / "run");
}

TEST_CASE("5: the run folder cannot be made") {
  const Folder folder;
  const Result result = [&] {
    spill(folder / "scene.json", ball().dump());
    return call(folder, {"run", "scene.json", "--out", "/proc/no/run"});
  }();
  INFO(result.err);
  CHECK(result.code == 5);
  CHECK(has(result.err, "cannot create the folder /proc/no/run"));
}

TEST_CASE("pictures that cannot be drawn do not cost the numbers") {
  const Folder folder;
  Json scene = ball();
  scene["solver"]["end_time"] = 2.0;
  scene["output"]["metrics_every"] = 1;
  scene["figures"] = {"energy"};
  spill(folder / "scene.json", scene.dump());
  Process process(folder, program({"run", "scene.json", "--out", "run", "--threads", "1"}));
  REQUIRE(process.wait_until([&] { return rows_written(folder / "run/metrics.csv", 2); }));
  spill(folder / "run/figures", "a file where the folder should be");
  const Result result = process.finish();
  INFO(result.err);
  CHECK(result.code == 5);
  CHECK(has(result.err, "pictures are missing: "));
  CHECK(has(result.err, "`mpm figure "));
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["steps"] == 1000);
  CHECK(summary["outcome"]["exit_code"] == 5);
  CHECK(has(slurp(folder / "run/report.html"), "</html>"));
}

TEST_CASE("130: Ctrl-C") {
  interrupt_with(SIGINT);
}

TEST_CASE("130: a polite kill") {
  interrupt_with(SIGTERM);
}

TEST_CASE("a reader of the messages that goes away does not end the run") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump());
  const std::string command =
      "{ '" MPM_BUILD_DIR "/bin/mpm' run scene.json --out run --threads 1 2>&1; echo $? > code; } | :";
  Process(folder, {"/bin/sh", "-c", command}).finish();
  CHECK(slurp(folder / "code") == "0\n");
  CHECK(json_in(folder / "run/summary.json")["steps"] == 50);
}

TEST_CASE("kill -9 leaves whole files, and the folder can be used again") {
  const Folder folder;
  Json scene = endless_ball();
  scene["output"]["frames"] = 3;
  scene["output"]["vtk"] = true;
  spill(folder / "scene.json", scene.dump());
  const fs::path manifest = folder / "run/manifest.json";
  for (const int rows : {0, 1, 50}) {
    // The manifest is the first file of a run, written after all of the earlier one are gone.
    const auto earlier = fs::exists(manifest) ? fs::last_write_time(manifest) : fs::file_time_type::min();
    Process process(folder, program({"run", "scene.json", "--out", "run", "--threads", "1"}));
    REQUIRE(process.wait_until([&] {
      return fs::exists(manifest) && fs::last_write_time(manifest) != earlier &&
             rows_written(folder / "run/metrics.csv", rows);
    }));
    process.send(SIGKILL);
    CHECK(process.finish().signal == SIGKILL);
    check_whole(folder / "run");
    json_in(folder / "run/manifest.json");
    json_in(folder / "run/experiment.json");
    CHECK(!fs::exists(folder / "run/summary.json"));
  }
  const Result drawn = call(folder, {"figure", "run"});
  INFO(drawn.err);
  CHECK(drawn.code == 0);
  CHECK(fs::exists(folder / "run/figures/energy.png"));
  const Result again = run_scene(folder, ball());
  CHECK(again.code == 0);
  CHECK(folder.names() == Words{"run", "scene.json"});
  for (const auto& entry : fs::recursive_directory_iterator(folder / "run"))
    CHECK(!has(entry.path().filename().string(), ".tmp"));
  CHECK(fs::exists(folder / "run/summary.json"));
}
