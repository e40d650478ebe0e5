// The scenes of the gallery say what is to come of them in `compare`, and it comes.

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

std::vector<fs::path> scenes() {
  std::vector<fs::path> all;
  for (const auto& entry : fs::directory_iterator(fs::path(MPM_SOURCE_DIR) / "experiments/gallery"))
    all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

Json expectations(const fs::path& scene) {
  const Json file = Json::parse(slurp(scene), nullptr, true, true);
  return file.contains("compare") ? file["compare"].value("expect", Json::array()) : Json::array();
}

/// Runs a scene; every one of its expectations was judged and holds.
void check_run(const fs::path& scene) {
  const Folder folder;
  INFO(scene);
  const Result result =
      call(folder, {"run", scene.string(), "--out", "run", "--threads", "1", "--set", "/output/frames=0"});
  INFO(result.err);
  CHECK(result.code == 0);
  const Json found = json_in(folder / "run/summary.json")["expect"];
  CHECK(found.size() == expectations(scene).size());
  for (const Json& row : found) CHECK(row["held"] == true);
}

}  // namespace

TEST_CASE("every scene of the gallery expects something that can fail", "[gallery]") {
  CHECK(scenes().size() >= 13);
  for (const fs::path& scene : scenes()) {
    INFO(scene);
    const Json rows = expectations(scene);
    CHECK(rows.size() >= 1);
    for (const Json& row : rows) CHECK((row.contains("at_least") || row.contains("at_most") || row.contains("equals")));
  }
}

TEST_CASE("a slope, a slump and a torn bar come to what their scenes expect, and not by other numbers", "[gallery]") {
  const fs::path gallery = fs::path(MPM_SOURCE_DIR) / "experiments/gallery";
  for (const char* name : {"slope_failure", "polymer_slump", "notched_bar"})
    check_run(gallery / (std::string(name) + ".json"));
  // A slope that is steep enough for its strength stays, which its bounds tell.
  const Folder folder;
  const Result result = call(folder, {"run", (gallery / "slope_failure.json").string(), "--out", "run", "--threads",
                                      "1", "--set", "/output/frames=0", "--set", "/materials/soil/cohesion=40 kPa"});
  INFO(result.err);
  CHECK(result.code == 4);
  CHECK(has(result.err, "centre_of_mass.final.x"));
}

TEST_CASE("every scene of the gallery comes to what it expects", "[gallery][slow]") {
  for (const fs::path& scene : scenes()) check_run(scene);
}
