// Exit codes 0, 2 and 4, and the message that comes with each.

#include <cmath>

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

/// Bad input gives code 2, the message, nothing on standard output, and not a file more than before.
void refused(const Folder& folder, const Words& words, const std::string& message) {
  const auto before = folder.names();
  const Result result = call(folder, words);
  INFO(result.err);
  INFO("expected: " << message);
  CHECK(result.code == 2);
  CHECK(has(result.err, message));
  CHECK(result.out.empty());
  CHECK(folder.names() == before);
}

void refused_scene(const Json& scene, const std::string& message, const Words& more = {}) {
  const Folder folder;
  spill(folder / "scene.json", scene.dump(1));
  Words words{"run", "scene.json", "--out", "run"};
  words.insert(words.end(), more.begin(), more.end());
  refused(folder, words, message);
}

}  // namespace

TEST_CASE("0: a run whose expectations hold") {
  const Folder folder;
  const Json scene =
      expecting(ball(), {{"metric", "energy.total.final_over_initial"}, {"at_least", 0.99}, {"at_most", 1.01}});
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(has(result.out, "report: run/report.html"));
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["outcome"]["exit_code"] == 0);
  CHECK(summary["outcome"]["status"] == "done");
  REQUIRE(summary["expect"].size() == 1);
  CHECK(summary["expect"][0]["held"] == true);
  CHECK(summary["performance"]["wall_seconds"].get<double>() > 0);
  CHECK((summary["performance"]["wall_seconds"].get<double>() < result.seconds));
  CHECK(summary["performance"]["peak_memory"].get<double>() > 1e6);
  CHECK(summary["performance"]["peak_memory"].get<double>() < 1e9);
}

TEST_CASE("progress that is not on a terminal is plain lines, none twice") {
  const Folder folder;
  const Result result = run_scene(folder, ball());
  INFO(result.err);
  CHECK(!has(result.err, "\r"));
  CHECK(!has(result.err, "\033"));
  std::istringstream lines(result.err);
  std::vector<std::string> steps;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("step ")) steps.push_back(line.substr(0, line.find(',')));
  CHECK(steps.size() >= 10);
  CHECK(steps.size() <= 12);
  CHECK(std::adjacent_find(steps.begin(), steps.end()) == steps.end());
  CHECK(steps.back() == "step 50");
}

TEST_CASE("2: the file") {
  const Folder folder;
  refused(folder, {"run", "missing.json"}, "missing.json: there is no such file\nnothing was run");
  refused(folder, {"check", "missing.json"}, "missing.json: there is no such file");
  refused(folder, {"plan", "missing.json"}, "missing.json: there is no such file");
  refused(folder, {"run", "."}, ".: ");
  spill(folder / "broken.json", "{\"title\": \"a\",\n  \"dimension\" 2}");
  refused(folder, {"run", "broken.json"}, "broken.json:2:15: ");
  spill(folder / "empty.json", "");
  refused(folder, {"run", "empty.json"}, "empty.json: ");
}

TEST_CASE("2: every mistake in a file at once, with place and nearest name") {
  const Folder folder;
  std::string text = ball().dump(1);
  const auto replace = [&](const std::string& from, const std::string& to) {
    REQUIRE(has(text, from));
    text.replace(text.find(from), from.size(), to);
  };
  replace("\"poisson_ratio\"", "\"poison_ratio\"");
  replace("\"mls\"", "\"msl\"");
  replace("\"end_time\"", "\"endtime\"");
  spill(folder / "scene.json", text);
  const Result result = call(folder, {"run", "scene.json"});
  INFO(result.err);
  CHECK(result.code == 2);
  CHECK(has(result.err, "did you mean \"poisson_ratio\"?"));
  CHECK(has(result.err, "did you mean \"mls\"?"));
  CHECK(has(result.err, "did you mean \"end_time\"?"));
  CHECK(has(result.err, "/transfer"));
  CHECK(has(result.err, "mistakes; nothing was run"));
  std::istringstream lines(result.err);
  std::string line;
  std::getline(lines, line);
  int row = 0, column = 0;
  CHECK(std::sscanf(line.c_str(), "scene.json:%d:%d: /", &row, &column) == 2);
  CHECK(!fs::exists(folder / "runs"));
}

TEST_CASE("2: verbs and options") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump());
  refused(folder, {}, "--help");
  refused(folder, {"rnu", "scene.json"}, "no verb is called \"rnu\"; did you mean \"run\"?");
  refused(folder, {"frobnicate"}, "verbs are \"run\", \"check\", \"plan\"");
  refused(folder, {"run", "scene.json", "--thread", "2"}, "mpm run takes no \"--thread\"; did you mean \"--threads\"?");
  refused(folder, {"run"}, "FILE");
  refused(folder, {"run", "scene.json", "--threads", "0"}, "--threads");
  refused(folder, {"run", "scene.json", "--threads", "many"}, "--threads");
  refused(folder, {"describe"}, "ID");
  refused(folder, {"run", "scene.json", "--set", "/solver/end_tim=1"}, "end_time");
  refused(folder, {"run", "scene.json", "--set", "nonsense"}, "--set");
  refused(folder, {"run", "scene.json", "--backend", "gpu"},
          "--backend: /backend: expected one of \"reference\", \"cpu\", \"cuda\", got \"gpu\"");
}

TEST_CASE("2: combinations that cannot run") {
  Json scene = ball();
  scene["precision"] = "float";
  refused_scene(scene, "precision \"float\" is not available on backend \"reference\"", {"--backend", "reference"});
  scene = ball();
  scene["transfer"]["type"] = "./evil.so";
  refused_scene(scene, "/transfer/type: unknown transfer \"./evil.so\"");
  scene = ball();
  scene["bodies"][0]["geometry"]["centre"] = {5.0, 5.0};
  refused_scene(scene, "/bodies/0/geometry");
  scene = ball();
  scene["bodies"][0]["velocity"] = {"sqrt(x - 0.5)", 0};
  refused_scene(scene,
                "/bodies/0/velocity/0: is not a finite number at particle 0, (0.425, 0.325) m: "
                "\"sqrt(x - 0.5)\" at character 1 is sqrt(-0.075");
  scene["bodies"][0]["initial_displacement"] = {0.1, 0};
  scene["bodies"][0]["velocity"] = {"sqrt(X - 0.5)", 0};  // which began at another place
  refused_scene(scene, "(0.525, 0.325) m: \"sqrt(X - 0.5)\" at character 1 is sqrt(-0.075");
}

TEST_CASE("2: temperatures that nothing can have at the start, in a body, at a wall and in a box") {
  for (const char* backend : {"cpu", "reference"}) {
    const Words chosen{"--backend", backend};
    const std::string first = " at particle 0, (0.425, 0.325) m";
    refused_scene(
        warm_ball("sqrt(x - 0.5)*300"),
        "/bodies/0/temperature: is not a finite number" + first + ": \"sqrt(x - 0.5)\" at character 1 is sqrt(-0.075",
        chosen);
    refused_scene(warm_ball("-100*x"), "/bodies/0/temperature: is -42.5 K, below 0 K," + first, chosen);
  }
  Json scene = warm_ball();
  scene["grid"]["boundaries"]["x_max"] = {{"type", "slip"}, {"temperature", "300 - 400*y"}};
  refused_scene(scene, "/grid/boundaries/x_max/temperature: is -20 K, below 0 K, at t = 0 s, (1, 0.8) m");
  scene = warm_ball();
  scene["grid"]["boundaries"]["y_min"] = {{"type", "slip"}, {"heat_flux", "log(x)"}};
  refused_scene(scene,
                "/grid/boundaries/y_min/heat_flux: is not a finite number at t = 0 s, (0, 0) m: \"log(x)\" at "
                "character 1 is log(0)");
  scene = ball();
  scene["grid"]["boundaries"]["y_min"] = {{"type", "prescribed"}, {"velocity", {0, "1/x"}}};
  refused_scene(scene,
                "/grid/boundaries/y_min/velocity/1: is not a finite number at t = 0 s, (0, 0) m: \"1/x\" at "
                "character 1 is 1 / 0");
  scene = warm_ball();
  scene["node_conditions"] = {
      {{"type", "thermal"}, {"lower", {0.2, 0.4}}, {"upper", {0.3, 0.6}}, {"temperature", "200*(x - 0.25)"}}};
  refused_scene(scene, "/node_conditions/0/temperature: is -10 K, below 0 K, at t = 0 s, (0.2, 0.4) m");
}

TEST_CASE("2: what a body begins in names the operation that gives no number, its line and place") {
  const auto begins = [](const char* key, const Json& value, const std::string& text) {
    Json scene = ball();
    scene["bodies"][0][key] = value;
    refused_scene(scene, text);
  };
  begins(
      "initial_displacement", {0, "log(X - 0.5)"},
      "/bodies/0/initial_displacement/1: is not a finite number at (0.425, 0.325) m: \"log(X - 0.5)\" at character 1 "
      "is log(-0.075");
  begins("initial_deformation_gradient", {{"xy", "1 + sqrt(Y - 0.5)"}},
         "/bodies/0/initial_deformation_gradient/xy: is not a finite number at (0.425, 0.325) m: \"sqrt(Y - 0.5)\" at "
         "character 5 is sqrt(-0.175");
  begins(
      "initial_stress", {{"yy", "1/(X - X)"}},
      "/bodies/0/initial_stress/yy: is not a finite number at (0.425, 0.325) m: \"1/(X - X)\" at character 1 is 1 / 0");
}

TEST_CASE("a grip that leaves a component free beside contact is warned of, and no other") {
  const Folder folder;
  Json scene = two_balls();
  scene["grips"] = {{{"body", "ball"}, {"velocity", {0, 0}}, {"where", scene["bodies"][0]["geometry"]}}};
  spill(folder / "held.json", scene.dump());
  CHECK_FALSE(has(call(folder, {"check", "held.json"}).err, "/grips/0"));
  scene["grips"][0]["velocity"] = {0, nullptr};
  spill(folder / "loose.json", scene.dump());
  const Result checked = call(folder, {"check", "loose.json"});
  CHECK(checked.code == 0);
  CHECK(has(checked.err, "warning: /grips/0 leaves a component of \"ball\" free, and contact takes the body for one"));
  scene.erase("contact");
  spill(folder / "alone.json", scene.dump());
  CHECK_FALSE(has(call(folder, {"check", "alone.json"}).err, "/grips/0"));
}

TEST_CASE("2: two bodies of the same particles, and a warning of those that have most of them in one place") {
  Json scene = two_balls();
  scene.erase("contact");
  scene["bodies"][1]["geometry"] = scene["bodies"][0]["geometry"];
  refused_scene(scene,
                "/bodies/1: body \"other\" has the particles of body \"ball\" in the very same places, 208 of them; "
                "move one of them, or remove it");
  const Folder folder;
  scene["bodies"][1]["geometry"] = {{"type", "ball"}, {"centre", {0.32, 0.3}}, {"radius", 0.15}};
  spill(folder / "scene.json", scene.dump());
  const Result checked = call(folder, {"check", "scene.json"});
  INFO(checked.err);
  CHECK(checked.code == 0);
  CHECK(has(checked.err, "warning: bodies \"ball\" and \"other\" begin in one place: "));
  int inside = 0;  // the smaller ball lies in the larger one, every particle
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) inside += std::hypot((i + 0.5) * 0.025 - 0.32, (j + 0.5) * 0.025 - 0.3) <= 0.15;
  CHECK(has(checked.err,
            ", and " + std::to_string(inside) + " of \"other\" in \"ball\", so that the mass is there twice"));
  const Result ran = call(folder, {"run", "scene.json", "--out", "run"});
  CHECK(ran.code == 0);
  CHECK(has(json_in(folder / "run/summary.json")["warnings"].dump(), "begin in one place"));
  spill(folder / "apart.json", two_balls().dump());
  CHECK(call(folder, {"check", "apart.json"}).err.empty());
  // Blocks side by side share a face and no particle.
  const auto block = [](double x) { return Json{{"type", "box"}, {"lower", {x, 0.3}}, {"upper", {x + 0.2, 0.5}}}; };
  scene["bodies"][0]["geometry"] = block(0.2), scene["bodies"][1]["geometry"] = block(0.4);
  spill(folder / "beside.json", scene.dump());
  CHECK(call(folder, {"check", "beside.json"}).err.empty());
}

// With s = 1.489 the formula has its pole at J = 1 - 1/s = 0.328 and goes on along its tangent from 1 - 0.9/s = 0.3956 on.
TEST_CASE("a warning of a fluid that is compressed beyond the formula of Mie-Gruneisen") {
  Json scene = ball();
  scene["materials"]["m"] = {{"type", "newtonian_fluid"},
                             {"equation_of_state", "mie_gruneisen"},
                             {"bulk_modulus", 1000},
                             {"density", 1000},
                             {"viscosity", 0}};
  scene["bodies"][0].erase("velocity");
  scene["solver"] = {{"time_step", 1e-5}, {"end_time", 2e-5}};
  scene["limits"] = {{"volume_ratio", nullptr}};
  const Folder folder;
  for (const double J : {0.39, 0.41}) {
    INFO(J);
    scene["bodies"][0]["initial_deformation_gradient"] = {{"xx", J}};
    CHECK(run_scene(folder, scene).code == 0);
    const std::string warnings = json_in(folder / "run/summary.json")["warnings"].dump();
    INFO(warnings);
    CHECK(has(warnings, "below J = 0.396, the pressure of mie_gruneisen goes on") == (J < 0.3956));
  }
}

TEST_CASE("a warning of particles that begin or are emitted inside a rigid body, and none of those on its face") {
  Json scene = two_balls();
  scene["bodies"] = Json::array({scene["bodies"][0]});
  scene.erase("contact");
  scene["bodies"][0]["geometry"] = {{"type", "box"}, {"lower", {0.2, 0.1}}, {"upper", {0.6, 0.5}}};
  scene["rigid_bodies"] = Json::parse(R"([{"name": "floor", "contact": {"type": "frictionless"},
    "geometry": {"type": "half_space", "point": [0, 0.1], "normal": [0, 1]}}])");
  const Folder folder;
  spill(folder / "on_it.json", scene.dump());
  CHECK(call(folder, {"check", "on_it.json"}).err.empty());
  // Rows of particles are 0.025 m apart, the lowest half of that above the block's face: four are below the floor's.
  scene["rigid_bodies"][0]["geometry"]["point"] = {0, 0.2};
  spill(folder / "in_it.json", scene.dump());
  const Result checked = call(folder, {"check", "in_it.json"});
  INFO(checked.err);
  CHECK(checked.code == 0);
  CHECK(has(checked.err,
            "warning: 64 particles of body \"ball\" begin inside rigid body \"floor\", the deepest 0.0875 m"));
  const Result ran = call(folder, {"run", "in_it.json", "--out", "run"});
  CHECK(has(json_in(folder / "run/summary.json")["warnings"].dump(), "begin inside rigid body"));
  // An emitter counts by its region: of the four rows that fill it two are below the floor's face.
  Json emitting = scene;
  emitting["emitters"] = Json::parse(R"([{"name": "nozzle", "body": "ball", "velocity": [0, -1],
    "geometry": {"type": "box", "lower": [0.2, 0.15], "upper": [0.3, 0.25]}}])");
  emitting["bodies"][0].erase("geometry");
  spill(folder / "emitter.json", emitting.dump());
  const Result emitter = call(folder, {"check", "emitter.json"});
  INFO(emitter.err);
  CHECK(has(emitter.err,
            "warning: 8 particles of each batch of emitter \"nozzle\" begin inside rigid body \"floor\", the deepest "
            "0.0375 m"));
  // A slope through the block's middle: the particles below it, but for those on its face.
  scene["rigid_bodies"][0]["geometry"] = {{"type", "half_space"}, {"point", {0.4, 0.3}}, {"normal", {1, 1}}};
  spill(folder / "slope.json", scene.dump());
  int below = 0;
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j) below += i + j < 15;
  CHECK(has(call(folder, {"check", "slope.json"}).err, "warning: " + std::to_string(below) + " particles of body"));
}

TEST_CASE("2: a load on the axis alone, and gravity along the radius, are refused with what to write") {
  Json rod = ball();
  rod["grid"]["symmetry"] = "axisymmetric";
  rod["transfer"]["type"] = "flip";
  rod["bodies"][0]["velocity"] = {0, 0};
  rod["bodies"][0]["geometry"] = {{"type", "box"}, {"lower", {0, 0.2}}, {"upper", {0.4, 0.8}}};
  const Folder folder;
  const auto checked = [&](const Json& scene) {
    spill(folder / "scene.json", scene.dump(1));
    return call(folder, {"check", "scene.json"});
  };
  const auto pressed = [&](const Json& where) {
    Json scene = rod;
    scene["loads"] = {{{"type", "pressure"}, {"body", "ball"}, {"pressure", 10}, {"where", where}}};
    return scene;
  };
  refused_scene(
      pressed({{"type", "box"}, {"lower", {0, 0.3}}, {"upper", {0.001, 0.7}}}),
      "/loads/0/where: of the surface of body \"ball\" this region holds the axis alone, where rings have no area, "
      "so that the load has nothing to act on; take a region that holds surface at x > 0, or a load of type "
      "\"force\" along the axis");
  CHECK(checked(pressed({{"type", "box"}, {"lower", {0.39, 0.3}}, {"upper", {0.41, 0.7}}})).code == 0);
  CHECK(checked(pressed({{"type", "half_space"}, {"point", {0, 0.8}}, {"normal", {0, -1}}})).code == 0);
  const auto pulled = [&](const Json& gravity) {
    Json scene = rod;
    scene["gravity"] = gravity;
    return scene;
  };
  const std::string radial = "/gravity: gravity cannot pull along the radius (x) of an axisymmetric scene: write [0, ";
  refused_scene(pulled({-9.81, 0}), radial + "-9.81], which acts along the axis (y)");
  refused_scene(pulled({1, -3}), radial + "-3], which acts along the axis (y)");
  refused_scene(pulled({"t", 0}),
                radial + "\"...\"], the formula as its second component, which acts along the axis (y)");
  CHECK(checked(pulled({0, -9.81})).code == 0);
}

TEST_CASE("2: a grip that holds nothing") {
  Json scene = ball();
  scene["grips"] = {{{"body", "ball"}, {"where", scene["bodies"][0]["geometry"]}, {"velocity", {nullptr, nullptr}}}};
  refused_scene(scene,
                "/grips/0/velocity: holds nothing: every component is null; give one a velocity (0 holds it), or "
                "remove the grip");
  scene["grips"][0]["velocity"][1] = 0;
  const Folder folder;
  CHECK(run_scene(folder, scene).code == 0);
}

TEST_CASE("damping of nothing is refused, and zeros that a study may set are warned of") {
  const Folder folder;
  Json scene = ball();
  scene["damping"] = Json::object();
  refused_scene(scene, "/damping: damps nothing: give \"viscous\" (1/s) or \"local\" (a share), or remove \"damping\"");
  scene["damping"] = {{"viscous", 0}};
  spill(folder / "scene.json", scene.dump());
  const Result checked = call(folder, {"check", "scene.json"});
  CHECK(checked.code == 0);
  CHECK(has(checked.err, "warning: /damping damps nothing, as \"viscous\" and \"local\" are 0"));
}

TEST_CASE("2: a figure without its numbers, before the run") {
  const Folder folder;
  std::string text = ball().dump();
  text.insert(text.size() - 1, ",\n \"figures\": [\"energy\", \"contact\",\n  \"error\"]");
  spill(folder / "scene.json", text);
  refused(
      folder, {"run", "scene.json", "--out", "run"},
      "scene.json:2:24: /figures/1: figure \"contact\" needs \"contact nodes\", which the run does not record: give "
      "the experiment a \"contact\"\n"
      "scene.json:3:3: /figures/2: figure \"error\" needs \"position error rms\"");
  refused(folder, {"run", "scene.json", "--set", "/figures=[\"contact\"]"}, "command line: /figures/0: figure");
}

TEST_CASE("2: a scene too large for memory is refused at once, with the estimate") {
  const Folder folder;
  Json scene = ball();
  scene["grid"]["cell_size"] = 1e-5;
  spill(folder / "scene.json", scene.dump());
  const Result result = call(folder, {"run", "scene.json", "--out", "run"});
  INFO(result.err);
  CHECK(result.code == 2);
  CHECK((result.processor_seconds < 5));
  CHECK(has(result.err, "/grid/cell_size: the scene needs about"));
  CHECK(has(result.err, "GB of state"));
  CHECK(has(result.err, "are free; use larger cells"));
  CHECK(!fs::exists(folder / "run"));
}

TEST_CASE("2: an --out folder that holds something else stays as it is") {
  const Folder folder;
  fs::create_directory(folder / "thesis");
  spill(folder / "thesis/chapter.tex", "years of work");
  spill(folder / "scene.json", ball().dump());
  refused(folder, {"run", "scene.json", "--out", "thesis"}, "holds files that are not an earlier run");
  CHECK(slurp(folder / "thesis/chapter.tex") == "years of work");
  refused(folder, {"run", "scene.json", "--out", "scene.json"}, "is a file; choose another folder with --out");
  CHECK(json_in(folder / "scene.json") == ball());
}

TEST_CASE("2: an expectation of a number that no run records") {
  const Folder folder;
  std::string text = ball().dump();
  text.insert(text.size() - 1,
              ",\n \"compare\": {\"expect\": [\n"
              "  {\"metric\": \"energy.totl.final_over_initial\", \"at_most\": 2}]}");
  spill(folder / "scene.json", text);
  for (const char* verb : {"run", "check"})
    refused(folder, {verb, "scene.json"},
            "scene.json:3:14: /compare/expect/0/metric: no run of this experiment records "
            "\"energy.totl.final_over_initial\"; did you mean \"energy.total.final_over_initial\"?");
}

TEST_CASE("4: an expectation that fails, named with its place; everything is written") {
  const Folder folder;
  std::string text = ball().dump();
  text.insert(text.size() - 1,
              ",\n \"compare\": {\"expect\": [\n"
              "  {\"metric\": \"energy.total.final_over_initial\", \"at_least\": 1.5},\n"
              "    {\"metric\": \"particles\", \"equals\": 50, \"tolerance\": 1}]}");
  spill(folder / "scene.json", text);
  const Result result = call(folder, {"run", "scene.json", "--out", "run", "--threads", "1"});
  INFO(result.err);
  CHECK(result.code == 4);
  CHECK(has(result.err,
            "scene.json:3:3: /compare/expect/0: expected energy.total.final_over_initial at least 1.5, got "));
  CHECK(has(result.err, "scene.json:4:5: /compare/expect/1: expected particles 50 within 1, got 52"));
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["outcome"]["exit_code"] == 4);
  CHECK(summary["outcome"]["status"] == "expectation failed");
  for (const Json& entry : summary["expect"]) CHECK(entry["held"] == false);
  CHECK(has(slurp(folder / "run/report.html"), "energy.total.final_over_initial"));
}
