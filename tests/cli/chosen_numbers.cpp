// Bodies, groups, probes, pairs and figures of columns as `mpm run` records them and `mpm check` checks them.

#include <map>
#include <sstream>

#include "cli/program.hpp"
#include "support/csv.hpp"

using namespace mpm::test;

namespace {

/// Two balls that meet, with everything that can be asked for.
Json asking() {
  Json scene = two_balls();
  scene["output"] = Json::parse(R"({"metrics_every": 3, "bodies": true, "contact_pairs": true, "normal_error": true,
    "groups": [{"name": "core", "body": "ball", "where": {"type": "ball", "centre": [0.3, 0.3], "radius": 0.1}}],
    "probes": [{"name": "tip", "quantities": ["velocity_x", "stress_xy"], "nearest": [0.4, 0.4]},
               {"name": "gap", "quantities": ["pressure"], "place": [0.45, 0.45]},
               {"name": "nowhere", "quantities": ["pressure"], "place": [0.1, 0.9]},
               {"name": "cut", "section": {"point": [0.3, 0.3], "normal": [1, 1]}},
               {"name": "line", "quantities": ["volume_ratio", "displacement_x"],
                "line": {"from": [0.1, 0.1], "to": [0.8, 0.8], "count": 15, "profiles": 3}}]})");
  scene["figures"] = Json::parse(R"(["energy", {"type": "columns", "name": "ball_speeds", "title": "Speeds",
      "columns": ["body ball velocity x", "body other velocity x"]}])");
  return scene;
}

mpm::support::Table metrics_of(const fs::path& run) {
  return mpm::support::read_csv(run / "metrics.csv");
}

/// What `mpm check` says of a scene that it refuses.
std::string refusal(const Json& scene, const std::string& verb = "check") {
  const Folder folder;
  spill(folder / "scene.json", scene.dump(1));
  const Result result = call(folder, {verb, "scene.json"});
  INFO(result.err);
  CHECK(result.code == 2);
  CHECK(folder.names() == Words{"scene.json"});
  return result.err;
}

}  // namespace

TEST_CASE("what is asked for has columns, a place in the summary, figures and files") {
  const Folder folder;
  Json scene = asking();
  scene["compare"]["expect"] = Json::parse(R"([{"metric": "bodies.ball.mass.final", "at_least": 1},
    {"metric": "pairs.ball.other.force_x.smallest", "at_most": 0}, {"metric": "groups.core.velocity_x.initial", "equals": 1, "tolerance": 1e-9},
    {"metric": "probes.tip.velocity_x.largest", "at_least": 0.9}])");
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  CHECK(result.code == 0);
  const auto table = metrics_of(folder / "run");
  for (const char* column : {"body ball mass (kg/m)", "body other angular velocity z (1/s)",
                             "group core momentum y (kg/s)", "probe tip stress_xy (Pa)", "probe gap pressure (Pa)",
                             "probe cut force x (N/m)", "pair ball other force x (N/m)", "pair ball other nodes"}) {
    INFO(column);
    CHECK(std::count(table.header.begin(), table.header.end(), column) == 1);
  }
  // The pair of the only two fields is what contact records; bodies sum to the scene.
  for (const char* axis : {"x", "y"})
    CHECK(*table.find(std::string("pair ball other force ") + axis) ==
          *table.find(std::string("contact force ") + axis));
  CHECK(*table.find("pair ball other nodes") == *table.find("contact nodes"));
  CHECK(*table.find("pair ball other largest penetration") == *table.find("largest penetration"));
  for (std::size_t k = 0; k < table.rows(); ++k)
    CHECK((*table.find("body ball kinetic energy"))[k] + (*table.find("body other kinetic energy"))[k] ==
          Approx((*table.find("kinetic energy"))[k]).epsilon(1e-12));
  const Json summary = json_in(folder / "run/summary.json");
  const Json& mass = summary["bodies"]["ball"]["mass"];
  CHECK(mass["initial"] == mass["largest"]);
  CHECK(summary["probes"]["tip"]["velocity_x"]["initial"].get<double>() == Approx(1));
  const std::vector<double>& speed = *table.find("body other velocity x");
  const Json& range = summary["bodies"]["other"]["velocity_x"];
  const auto [smallest, largest] = std::minmax_element(speed.begin(), speed.end());
  CHECK(*smallest < *largest);
  CHECK(range["smallest"].get<double>() == Approx(*smallest));
  CHECK(range["largest"].get<double>() == Approx(*largest));
  CHECK(summary["probes"]["nowhere"]["pressure"]["largest"].is_null());  // there is no material
  for (const char* file :
       {"figures/ball_speeds.png", "figures/ball_speeds.svg", "figures/energy.png", "probes/line.csv"})
    CHECK(fs::is_regular_file(folder / "run" / file));
  const auto profile = mpm::support::read_csv(folder / "run/probes/line.csv");
  CHECK(profile.rows() == 3 * 15);
  CHECK(profile.header ==
        std::vector<std::string>{"time (s)", "distance (m)", "x (m)", "y (m)", "volume_ratio", "displacement_x (m)"});
  CHECK((*profile.find("time"))[44] == Approx(0.08));
  CHECK(has(slurp(folder / "run/report.html"), "ball_speeds"));

  const Result again = call(folder, {"check", "run/experiment.json"});
  INFO(again.err);
  CHECK(again.code == 0);
  fs::remove(folder / "run/figures/ball_speeds.png");
  CHECK(call(folder, {"figure", "run"}).code == 0);
  CHECK(fs::is_regular_file(folder / "run/figures/ball_speeds.png"));
  spill(folder / "both.json", R"({"columns": ["body ball velocity y", "body other velocity y"]})");
  const Result drawn = call(folder, {"figure", "run", "--spec", "both.json"});
  INFO(drawn.err);
  CHECK(drawn.code == 0);
  CHECK(fs::is_regular_file(folder / "run/figures/both.png"));
}

TEST_CASE("the figures of pairs show the normal force, the size of the tangential one, and their impulses") {
  const Folder folder;
  Json scene = asking();
  scene["figures"] = {"contact_pairs"};
  REQUIRE(run_scene(folder, scene).code == 0);
  const auto table = metrics_of(folder / "run");
  for (const std::string quantity : {"force", "impulse"}) {
    const std::string file = quantity == "force" ? "contact_pairs" : "contact_pair_impulses";
    INFO(file);
    std::istringstream drawn(slurp(folder / "run/figures" / (file + ".csv")));
    std::map<std::string, std::vector<double>> curves;
    for (std::string line; std::getline(drawn, line);)
      if (line.starts_with('"'))  // "ball other, normal",computed,time,value,,
        curves[line.substr(1, line.find('"', 1) - 1)].push_back(
            std::stod(line.substr(line.find(',', line.find(",computed,") + 10) + 1)));
    const auto named = [&](const std::string& part, const std::string& axis = "") {
      return *table.find("pair ball other " + part + quantity + axis);
    };
    REQUIRE(curves.size() == 2);
    const std::vector<double> normal = named("normal "), x = named("tangential ", " x"), y = named("tangential ", " y");
    CHECK(*std::max_element(normal.begin(), normal.end()) > 0);
    REQUIRE(curves["ball other, normal"].size() == table.rows());
    for (std::size_t k = 0; k < table.rows(); ++k) {
      CHECK(curves["ball other, normal"][k] == Approx(normal[k]));
      CHECK(curves["ball other, tangential"][k] == Approx(std::hypot(x[k], y[k])));
    }
    CHECK(fs::is_regular_file(folder / "run/figures" / (file + ".png")));
    CHECK(has(slurp(folder / "run/report.html"), file));
  }
  scene["output"].erase("contact_pairs"), scene["output"].erase("normal_error");
  const std::string said = refusal(scene);
  INFO(said);
  CHECK(has(said, R"(figure "contact_pairs" needs "pair ", which the run does not record)"));
}

TEST_CASE("nothing of it is there unless it is asked for, and asking changes no other number") {
  const Folder folder;
  Json scene = two_balls();
  scene["output"]["metrics_every"] = 3;
  REQUIRE(run_scene(folder, scene).code == 0);
  const auto bare = metrics_of(folder / "run");
  const Json summary = json_in(folder / "run/summary.json");
  for (const char* group : {"bodies", "groups", "probes", "pairs"}) CHECK(!summary.contains(group));
  CHECK(!fs::exists(folder / "run/probes"));
  const Folder other;
  REQUIRE(run_scene(other, asking()).code == 0);
  const auto asked = metrics_of(other / "run");
  REQUIRE(asked.header.size() > bare.header.size());
  for (std::size_t k = 0; k < bare.header.size(); ++k) {
    CHECK(asked.header[k] == bare.header[k]);
    CHECK(asked.columns[k] == bare.columns[k]);
  }
}

TEST_CASE("a resumed run writes the same bytes of them") {
  const Folder folder;
  Json scene = asking();
  scene["output"]["checkpoint_steps"] = 7;
  REQUIRE(run_scene(folder, scene).code == 0);
  for (const int steps : {10, 23, 36}) {
    INFO(steps);
    spill(folder / "scene.json", scene.dump(1));
    const Words part{"run", "scene.json", "--out", "part", "--threads", "1"};
    Words stopped = part;
    stopped.insert(stopped.end(), {"--set", "/solver/max_steps=" + std::to_string(steps)});
    CHECK(call(folder, stopped).code == 3);
    Words resumed = part;
    resumed.push_back("--resume");
    const Result result = call(folder, resumed);
    INFO(result.err);
    CHECK(result.code == 0);
    for (const char* file : {"metrics.csv", "probes/line.csv", "figures/ball_speeds.csv"})
      CHECK((slurp(folder / "part" / file) == slurp(folder / "run" / file)));
    const Json whole = json_in(folder / "run/summary.json"), again = json_in(folder / "part/summary.json");
    for (const char* group : {"bodies", "groups", "probes", "pairs", "warnings"}) CHECK(whole[group] == again[group]);
    fs::remove_all(folder / "part");
  }
}

TEST_CASE("names that no record has are mistakes of the file, with place and nearest name") {
  Json scene = asking();
  scene["compare"]["expect"] = Json::parse(R"([{"metric": "bodies.bal.mass.final", "at_least": 1}])");
  CHECK(has(refusal(scene),
            "/compare/expect/0/metric: no run of this experiment records \"bodies.bal.mass.final\"; did "
            "you mean \"bodies.ball.mass.final\"?"));
  CHECK(has(refusal(scene, "run"), "/compare/expect/0/metric: no run of this experiment records"));
  scene = asking();
  scene["figures"][1]["columns"][0] = "body ball velocty x";
  const std::string column = refusal(scene);
  CHECK(has(column,
            "/figures/1/columns/0: no run of this experiment has a column \"body ball velocty x\"; did you mean "
            "\"body ball velocity x\"?"));
  CHECK(column.starts_with("scene.json:"));
  scene = asking();
  scene["output"]["probes"][0]["quantities"][0] = "equivalent_plastic_strain";
  CHECK(has(refusal(scene),
            "/output/probes/0/quantities/0: no particle of this experiment has "
            "\"equivalent_plastic_strain\""));
  scene["output"]["probes"][0]["quantities"][0] = "velocityx";
  CHECK(has(refusal(scene), "did you mean \"velocity_x\"?"));
  scene = asking();
  scene["output"]["groups"][0]["where"]["centre"] = {0.9, 0.1};
  CHECK(has(refusal(scene), "/output/groups/0/where: no particle begins in this region"));
  scene = asking();
  scene["output"]["bodies"] = {"ball", "othr"};
  CHECK(has(refusal(scene), "/output/bodies/1: there is no body \"othr\"; did you mean \"other\"?"));
  scene = asking();
  scene["output"]["probes"][1]["nearest"] = {0.1, 0.1};
  CHECK(has(refusal(scene), "/output/probes/1: says more than one place"));
  scene = asking();
  scene.erase("contact");
  CHECK(has(refusal(scene), "/output/contact_pairs: there are no pairs without \"contact\" or \"rigid_bodies\""));
  scene["output"]["contact_pairs"] = false, scene["output"]["contact_nodes"] = true;
  CHECK(has(refusal(scene), "/output/contact_nodes: there are no such nodes without \"contact\""));
  scene = asking();
  scene["output"]["contact_nodes"] = true;
  CHECK(has(refusal(scene), "/output/contact_nodes: they are shown in frames: give \"frames\""));
  scene = asking();
  scene["output"]["contact_pairs"] = false;
  CHECK(has(refusal(scene), "/output/normal_error: its columns are those of pairs: set \"contact_pairs\" to true"));
  scene["output"]["contact_pairs"] = true, scene["contact"] = {{"type", "stick"}};
  CHECK(has(refusal(scene), "/output/normal_error: the contact law \"stick\" has no normals"));
  scene = asking();
  scene["grid"]["boundaries"] = {{"all", "slip"}, {"x_min", "periodic"}, {"x_max", "periodic"}};
  CHECK(has(refusal(scene),
            "/output/normal_error: bodies are followed as wholes, and a periodic axis may take one apart"));
  scene.erase("contact");
  CHECK(has(refusal(scene), "/output/normal_error: there are no such normals without \"contact\""));
  const Folder folder;
  spill(folder / "points.csv", "x,y\n0.3,0.3\n0.31,0.3\n");
  scene = asking();
  scene["bodies"][0].erase("geometry");
  scene["bodies"][0]["seeding"] = {{"type", "points"}, {"file", (folder / "points.csv").string()}};
  CHECK(has(refusal(scene), "/output/normal_error: body \"ball\" has particles out of a file"));
  scene = two_balls();
  scene["output"]["ledger"] = false;
  scene["figures"] = {{{"type", "columns"}, {"name", "energy"}, {"columns", {"total energy"}}}, "ledger"};
  CHECK(has(refusal(scene), "/figures/0/name: there are two figures named \"energy\""));
  scene["figures"][0]["name"] = "mine";
  CHECK(has(refusal(scene), "/figures/1: figure \"ledger\" needs \"ledger residual\""));
}

TEST_CASE("the nodes where bodies meet stand in a table beside each frame, and add up to the pair") {
  const Folder folder;
  Json scene = asking();
  scene["output"]["frames"] = 2, scene["output"]["contact_nodes"] = true, scene["output"]["metrics_every"] = 1;
  scene["solver"]["end_time"] = 0.2;  // in the middle of the impact
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  CHECK(result.code == 0);
  const std::string before = slurp(folder / "run/frames/contact_0000.csv");
  CHECK(before ==
        "x (m),y (m),first,second,state,normal x,normal y,separation (m),area (m),force x (N/m),force y (N/m)\n");
  std::istringstream after(slurp(folder / "run/frames/contact_0001.csv"));
  std::string line;
  std::getline(after, line);
  double force = 0;
  int touching = 0;
  while (std::getline(after, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    REQUIRE(cells.size() == 11);
    CHECK((cells[2] == "ball" && cells[3] == "other"));
    CHECK((cells[4] == "apart" || cells[4] == "sticks" || cells[4] == "slips"));
    touching += cells[4] != "apart";
    force += std::stod(cells[9]);
  }
  const auto table = metrics_of(folder / "run");
  CHECK(touching > 0);
  CHECK(touching == table.find("pair ball other nodes")->back());
  CHECK(force == Approx(table.find("pair ball other force x (N/m)")->back()));
}

// A run asks for the names of its records of a few particles alone, and had counted those of the whole body there.
TEST_CASE("what the error of normals asks of the nodes where bodies meet is not drawn") {
  Json scene = asking();
  scene["output"]["frames"] = 2, scene["solver"]["end_time"] = 0.2;
  const Folder with, without;
  REQUIRE(run_scene(with, scene).code == 0);
  scene["output"]["normal_error"] = false;
  REQUIRE(run_scene(without, scene).code == 0);
  for (const char* frame : {"frame_0000.svg", "frame_0001.svg"})
    CHECK(slurp(with / "run/frames" / frame) == slurp(without / "run/frames" / frame));
}

TEST_CASE("a body of any number of particles has its numbers") {
  const Folder folder;
  Json scene = asking();
  scene["output"]["bodies"] = true;
  scene["bodies"][0]["particles_per_cell_axis"] = 8;
  scene["grid"]["cell_size"] = scene["grid"]["cell_size"].get<double>() / 8;
  spill(folder / "scene.json", scene.dump(1));
  const Result result = call(folder, {"check", "scene.json"});
  INFO(result.err << result.out);
  CHECK(result.code == 0);
  const std::size_t end = result.out.find(" particles");
  REQUIRE(end != std::string::npos);
  const std::string before = result.out.substr(0, end);
  CHECK(std::stol(before.substr(before.rfind(' ') + 1)) > 40000);
}

// The particles' affine velocities are not kept in steps that nobody records, so that nothing can be summed anew there.
TEST_CASE("a run that fails between two records keeps what was chosen, up to the last record") {
  const Folder folder;
  const Result result = call(folder, {"run", std::string(MPM_SOURCE_DIR) + "/experiments/papers/granular_collapse.json",
                                      "--out", "run", "--threads", "1", "--set", "/output/frames=0", "--set",
                                      "/grid/cell_size=0.01", "--set", "/grid/domain=[[0, 0], [0.14, 0.25]]"});
  INFO(result.err);
  CHECK(result.code == 3);
  CHECK(has(result.err, "left the domain"));
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["outcome"]["exit_code"] == 3);
  const auto table = metrics_of(folder / "run");
  CHECK(summary["bodies"]["column"]["velocity_x"]["final"] == Approx(table.find("body column velocity x")->back()));
}
