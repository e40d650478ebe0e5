// The scenes of the gallery say what is to come of them in `compare`, and it comes; the page shows each of them, in a
// picture or a film that its scene asks for.

#include <cstdint>
#include <regex>
#include <set>

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

const fs::path root = MPM_SOURCE_DIR;

Json scene_in(const fs::path& file) {
  return Json::parse(slurp(file), nullptr, true, true);
}

std::vector<fs::path> scenes() {
  std::vector<fs::path> all;
  for (const auto& entry : fs::directory_iterator(root / "experiments/gallery")) all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

Json expectations(const fs::path& scene) {
  const Json file = scene_in(scene);
  return file.contains("compare") ? file["compare"].value("expect", Json::array()) : Json::array();
}

/// Runs a scene; every one of its expectations was judged and holds.
void check_run(const fs::path& scene) {
  const Folder folder;
  INFO(scene);
  const Result result = call(folder, {"run", scene.string(), "--out", "run", "--threads", "1", "--set",
                                      "/output/frames=0", "--set", "/output/film=false"});
  INFO(result.err);
  CHECK(result.code == 0);
  const Json found = json_in(folder / "run/summary.json")["expect"];
  CHECK(found.size() == expectations(scene).size());
  for (const Json& row : found) CHECK(row["held"] == true);
}

/// What an animated WebP says of itself (developers.google.com/speed/webp/docs/riff_container).
struct Animation {
  bool loops_for_ever = false;
  std::uint32_t width = 0, pictures = 0, milliseconds = 0;
};

std::uint32_t number_at(const std::string& bytes, std::size_t at, int count) {
  std::uint32_t number = 0;
  for (int k = count - 1; k >= 0; --k) number = number << 8 | static_cast<unsigned char>(bytes.at(at + k));
  return number;
}

/// Fails the test when the file holds no animated WebP.
Animation animation_in(const fs::path& file) {
  const std::string bytes = slurp(file);
  REQUIRE((bytes.size() > 12 && bytes.starts_with("RIFF") && bytes.compare(8, 4, "WEBP") == 0));
  Animation animation;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::string name = bytes.substr(at, 4);
    const std::size_t size = number_at(bytes, at + 4, 4), body = at + 8;
    if (name == "VP8X") animation.width = number_at(bytes, body + 4, 3) + 1;
    if (name == "ANIM") animation.loops_for_ever = number_at(bytes, body + 4, 2) == 0;
    if (name == "ANMF") animation.pictures += 1, animation.milliseconds += number_at(bytes, body + 12, 3);
    at = body + size + size % 2;
  }
  REQUIRE(animation.pictures > 0);
  return animation;
}

/// The pictures and films of figures/gallery that a page shows, by the names of their files.
std::set<std::string> shown_on(const std::string& page) {
  std::set<std::string> names;
  const std::regex link(R"re(!\[[^\]]+\]\(\.\./figures/gallery/([a-z_]+\.(?:png|webp))\))re");
  for (std::sregex_iterator match(page.begin(), page.end(), link), end; match != end; ++match)
    names.insert((*match)[1]);
  return names;
}

}  // namespace

TEST_CASE("the page of the gallery shows every scene, and all of its pictures and films are there", "[gallery][docs]") {
  const std::string page = slurp(root / "docs/gallery.md");
  const std::set<std::string> shown = shown_on(page), of_papers = shown_on(slurp(root / "docs/papers.md"));
  std::set<std::string> kept;
  for (const auto& entry : fs::directory_iterator(root / "figures/gallery")) kept.insert(entry.path().filename());
  for (const std::string& name : shown) {
    INFO(name);
    CHECK(kept.count(name) == 1);
  }
  for (const std::string& name : kept) {
    INFO(name);
    CHECK((shown.count(name) == 1 || of_papers.count(name) == 1));
  }
  for (const fs::path& scene : scenes()) {
    const std::string name = scene.stem();
    INFO(name);
    const std::size_t command =
        page.find("```sh\n./mpm run experiments/gallery/" + name + ".json --out runs/" + name + "\n```\n");
    REQUIRE(command != std::string::npos);
    // What the command makes stands below it, before the next scene's heading.
    const std::string section = page.substr(command, page.find("\n## ", command) - command);
    const bool asks_for_film = scene_in(scene)["output"].value("film", Json(false)) == "webp";
    const std::string picture = "/" + name + (asks_for_film ? ".webp)" : ".png)");
    CHECK(has(section, picture));
  }
}

TEST_CASE("the films of the gallery are what their scenes ask for, in few bytes", "[gallery][docs]") {
  std::uintmax_t bytes = 0;
  int films = 0;
  for (const auto& entry : fs::directory_iterator(root / "figures/gallery")) {
    if (entry.path().extension() != ".webp") continue;
    INFO(entry.path());
    const fs::path scene = root / "experiments/gallery" / (entry.path().stem().string() + ".json");
    REQUIRE(fs::is_regular_file(scene));
    const Json output = scene_in(scene)["output"];
    REQUIRE(output["film"] == "webp");
    const std::uint32_t frames = output["frames"];
    CHECK((frames >= 25 && frames <= 60));
    const Animation film = animation_in(entry.path());
    CHECK(film.loops_for_ever);
    CHECK((film.width >= 480 && film.width <= 640));
    CHECK(film.pictures == frames + 20);
    CHECK(film.milliseconds == 50 * frames + 1000);
    CHECK(entry.file_size() <= 350'000);
    bytes += entry.file_size();
    ++films;
  }
  CHECK(films >= 6);
  CHECK(bytes <= 2'500'000);
}

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
  const fs::path gallery = root / "experiments/gallery";
  for (const char* name : {"slope_failure", "polymer_slump", "notched_bar"})
    check_run(gallery / (std::string(name) + ".json"));
  // A slope that is steep enough for its strength stays, which its bounds tell.
  const Folder folder;
  const Result result =
      call(folder, {"run", (gallery / "slope_failure.json").string(), "--out", "run", "--threads", "1", "--set",
                    "/output/frames=0", "--set", "/output/film=false", "--set", "/materials/soil/cohesion=40 kPa"});
  INFO(result.err);
  CHECK(result.code == 4);
  CHECK(has(result.err, "centre_of_mass.final.x"));
}

TEST_CASE("every scene of the gallery comes to what it expects", "[gallery][slow]") {
  for (const fs::path& scene : scenes()) check_run(scene);
}
