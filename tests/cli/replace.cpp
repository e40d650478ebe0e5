// A second run into a folder: what it replaces, what it refuses, and that nothing has to be cleaned up by hand.

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

Words files_below(const fs::path& folder) {
  Words names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder).string());
  std::sort(names.begin(), names.end());
  return names;
}

Result run_again(const Folder& folder, const Words& more = {}) {
  Words words{"run", "scene.json", "--threads", "1"};
  words.insert(words.end(), more.begin(), more.end());
  const Result result = call(folder, words);
  INFO(result.err);
  CHECK(result.signal == 0);
  return result;
}

/// Checks that a run is refused with these words and that no file is touched.
void refused(const Folder& folder, const Words& more, const Words& parts) {
  const std::string rows = slurp(folder / "runs/scene/metrics.csv");
  const Words names = files_below(folder.path());
  const Result result = run_again(folder, more);
  CHECK(result.code == 2);
  INFO(result.err);
  for (const std::string& part : parts) CHECK(has(result.err, part));
  CHECK(files_below(folder.path()) == names);
  CHECK(slurp(folder / "runs/scene/metrics.csv") == rows);
}

}  // namespace

TEST_CASE("the same experiment again says that it replaces, and leaves one folder") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump());
  const Result first = run_again(folder);
  CHECK(first.code == 0);
  CHECK(!has(first.err, "replaced"));
  const Words names = files_below(folder / "runs");
  spill(folder / "runs/scene/notes.txt", "mine");
  Json renamed = ball();
  renamed["title"] = "The same under another name";
  spill(folder / "scene.json", renamed.dump());
  const Result second = run_again(folder);
  CHECK(second.code == 0);
  CHECK(has(second.err, "runs/scene: the earlier run of the same experiment is replaced\n"));
  CHECK(slurp(folder / "runs/scene/notes.txt") == "mine");
  fs::remove(folder / "runs/scene/notes.txt");
  CHECK(files_below(folder / "runs") == names);
  CHECK(json_in(folder / "runs/scene/experiment.json")["title"] == "The same under another name");
}

TEST_CASE("results of another experiment are refused with the remedy, and replaced when asked for") {
  const Folder folder;
  Json scene = ball();
  scene["output"]["frames"] = 2;
  spill(folder / "scene.json", scene.dump());
  REQUIRE(run_again(folder).code == 0);
  refused(folder, {"--set", "/transfer/type=pic", "--set", "/output/frames=0"},
          {"runs/scene holds the results of another experiment (/transfer/type is \"mls\" there, and \"pic\" here): "
           "replace it with --replace, or choose another folder with --out"});
  refused(folder, {"--backend", "reference"}, {"/backend is \"cpu\" there, and \"reference\" here"});
  refused(folder, {"--replace", "--resume"}, {"--resume", "--replace"});
  const Result replaced = run_again(folder, {"--set", "/transfer/type=pic", "--set", "/output/frames=0", "--replace"});
  CHECK(replaced.code == 0);
  CHECK(has(replaced.err, "runs/scene: the earlier run is replaced (--replace)\n"));
  CHECK(!fs::exists(folder / "runs/scene/frames"));
  CHECK(json_in(folder / "runs/scene/experiment.json")["transfer"]["type"] == "pic");

  spill(folder / "runs/scene/experiment.json", "{");
  refused(folder, {}, {"holds a run whose experiment.json is damaged", "--replace"});
  fs::remove(folder / "runs/scene/experiment.json");  // as of a run that was killed at its very start
  CHECK(run_again(folder).code == 0);
}

TEST_CASE("a run out of its own folder's experiment replaces that folder") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump());
  REQUIRE(run_again(folder).code == 0);
  const std::string rows = slurp(folder / "runs/scene/metrics.csv");
  const Result again = call(folder, {"run", "runs/scene/experiment.json", "--out", "runs/scene", "--threads", "1"});
  INFO(again.err);
  CHECK(again.code == 0);
  CHECK(slurp(folder / "runs/scene/metrics.csv") == rows);
}

TEST_CASE("an unfinished run that can go on is not thrown away") {
  const Folder folder;
  Json scene = ball();
  scene["output"]["checkpoint_steps"] = 10;
  spill(folder / "scene.json", scene.dump());
  REQUIRE(run_again(folder, {"--set", "/solver/max_steps=25"}).code == 3);
  refused(folder, {},
          {"runs/scene holds an unfinished run of this experiment: go on with it with --resume, start anew with "
           "--replace, or choose another folder with --out"});
  const Result anew = run_again(folder, {"--replace"});
  CHECK(anew.code == 0);
  CHECK(!fs::exists(folder / "runs/scene/checkpoint"));
  CHECK(!json_in(folder / "runs/scene/summary.json")["performance"].contains("resumed_from_step"));
}

TEST_CASE("a study and an experiment are told apart by every verb") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump());
  Json study = Json::parse(R"J({"base": "scene.json", "axes": {"/transfer/type": ["pic", "flip"]},
                                "measure": {"loss": "/energy/total/final_over_initial"}, "error": "loss"})J");
  study["measure"]["loss"] = {{"value", "/energy/total/final_over_initial"}};
  spill(folder / "s.json", study.dump(1));
  for (const char* verb : {"run", "plan"}) {
    const Result result = call(folder, {verb, "s.json"});
    CHECK(result.code == 2);
    CHECK(has(result.err, "s.json:1:1: this is a study (it has \"base\" and \"axes\"), and mpm " + std::string(verb) +
                              " takes an experiment: use `mpm study s.json`"));
  }
  const Result wrong = call(folder, {"study", "scene.json"});
  CHECK(wrong.code == 2);
  CHECK(has(wrong.err,
            "scene.json:1:1: this is an experiment (it has \"bodies\"), and mpm study takes a study: use "
            "`mpm run scene.json`"));
  const Result good = call(folder, {"check", "s.json"});
  INFO(good.err);
  CHECK(good.code == 0);
  CHECK(good.out == "s.json: ok, a study of 2 combinations of scene.json\n");

  study["axes"]["/transfer/type"] = {"pic", "flop"};
  spill(folder / "s.json", study.dump(1));
  const Result one = call(folder, {"check", "s.json"});
  CHECK(one.code == 0);
  CHECK(has(one.out, "a study of 2 combinations of scene.json, of which 1 will be refused:\n  "));
  CHECK(has(one.out, "did you mean \"flip\"?"));
  study["axes"]["/transfer/type"] = {"flop"};
  spill(folder / "s.json", study.dump(1));
  const Result none = call(folder, {"check", "s.json"});
  CHECK(none.code == 2);
  CHECK(has(none.err, "did you mean \"flip\"?"));
  study["axis"] = Json::object();
  spill(folder / "s.json", study.dump(1));
  const Result unknown = call(folder, {"check", "s.json"});
  CHECK(unknown.code == 2);
  CHECK(has(unknown.err, "did you mean \"axes\"?"));
  CHECK(folder.names() == Words{"s.json", "scene.json"});
}

TEST_CASE("a run that replaced another is resumed by the command that it prints", "[replace]") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump());
  REQUIRE(call(folder, {"run", "scene.json"}).code == 0);
  const Result stopped = call(folder, {"run", "scene.json", "--replace", "--set", "/solver/max_steps=20"});
  INFO(stopped.err);
  CHECK(has(stopped.err, "resume with: ./mpm run scene.json --set /solver/max_steps=20 --resume"));
}

TEST_CASE("a check tries the first moment: what a run would refuse there, it refuses", "[replace]") {
  const Folder folder;
  const auto checked = [&](const Json& scene) {
    spill(folder / "scene.json", scene.dump(1));
    return call(folder, {"check", "scene.json"});
  };
  const Result good = checked(ball());
  CHECK(good.out == "scene.json: ok, 2-D, 1 body, 52 particles, bspline_quadratic + mls\n");
  Json scene = ball();
  scene["bodies"][0]["velocity"] = {"sqrt(0.1-x)", 0};
  CHECK(checked(scene).code == 2);
  CHECK(has(checked(scene).err, "/bodies/0/velocity/0: is not a finite number"));
  scene = ball();
  scene["grips"] = {{{"name", "hand"},
                     {"body", "ball"},
                     {"velocity", {0, 0}},
                     {"where", {{"type", "half_space"}, {"point", {0.1, 0}}, {"normal", {1, 0}}}}}};
  CHECK(checked(scene).code == 2);
  CHECK(has(checked(scene).err, "/grips/0/where: holds no particle"));
  scene = ball();
  scene["bodies"][0]["frozen"] = true;
  scene["loads"] = {{{"type", "spring"},
                     {"body", "ball"},
                     {"stiffness", {1, 1}},
                     {"where", {{"type", "half_space"}, {"point", {0.5, 0}}, {"normal", {-1, 0}}}}}};
  CHECK(has(checked(scene).err, "is frozen: its springs never stretch"));
  scene = ball();
  scene["grid"]["cell_size"] = 0.0005;
  scene["grid"]["domain"] = {{0, 0}, {1, 1}};
  CHECK(has(checked(scene).out, "particles (too many to be placed here)"));
}
