// Films of runs: the formats that an experiment may ask for, `mpm film`, and what a resumed run leaves. Most with a
// stand-in for ffmpeg, so that these need none.

#include <sys/stat.h>

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

/// The ball with five frames, and a film of them where a format is given.
Json filmed(const Json& film) {
  Json scene = ball();
  scene["output"]["frames"] = 5;
  scene["output"]["film"] = film;
  return scene;
}

/// A PATH with nothing on it but an ffmpeg that writes its own last word into the film.
Words stand_in(const Folder& folder) {
  fs::create_directory(folder / "bin");
  spill(folder / "bin/ffmpeg", "#!/bin/sh\nfor last; do :; done\necho \"made by the stand-in\" > \"$last\"\n");
  ::chmod((folder / "bin/ffmpeg").c_str(), 0755);
  return {"PATH=" + (folder / "bin").string()};
}

Words films_in(const fs::path& run) {
  Words names;
  for (const auto& entry : fs::directory_iterator(run))
    if (entry.path().stem() == "film") names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

Result run_filmed(const Folder& folder, const Json& film, const Words& environment, Words more = {}) {
  spill(folder / "scene.json", filmed(film).dump(1));
  Words words{"run", "scene.json", "--out", "run", "--threads", "1"};
  words.insert(words.end(), more.begin(), more.end());
  return call(folder, words, environment);
}

bool is_animated_webp(const std::string& bytes) {
  return bytes.starts_with("RIFF") && bytes.compare(8, 4, "WEBP") == 0 && has(bytes, "ANMF");
}

}  // namespace

TEST_CASE("a run makes the film that its experiment asks for, and another run takes it away", "[film]") {
  const Folder folder;
  const Words path = stand_in(folder);
  for (const char* format : {"mp4", "webm", "webp"}) {
    INFO(format);
    const Result result = run_filmed(folder, format, path, {"--replace"});
    INFO(result.err);
    CHECK(result.code == 0);
    CHECK(films_in(folder / "run") == Words{std::string("film.") + format});
    CHECK(has(slurp(folder / "run/report.html"), std::string("film.") + format));
  }
  CHECK(run_filmed(folder, true, path, {"--replace"}).code == 0);
  CHECK(films_in(folder / "run") == Words{"film.mp4"});
  CHECK(run_filmed(folder, false, path, {"--replace"}).code == 0);
  CHECK(films_in(folder / "run").empty());
}

TEST_CASE("a resumed run leaves the film of its own end alone", "[film]") {
  const Folder folder;
  const Words path = stand_in(folder);
  REQUIRE(run_filmed(folder, "mp4", path, {"--set", "/solver/max_steps=40"}).code == 3);
  REQUIRE(films_in(folder / "run") == Words{"film.mp4"});
  const Result result = run_filmed(folder, "webp", path, {"--resume"});
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(films_in(folder / "run") == Words{"film.webp"});
}

TEST_CASE("mpm film makes a film of a run that was recorded without one", "[film]") {
  const Folder folder;
  const Words path = stand_in(folder);
  REQUIRE(run_filmed(folder, false, path).code == 0);
  const Result result = call(folder, {"film", "run", "--format", "webp"}, path);
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(result.out == "film: run/film.webp\n");
  CHECK(call(folder, {"film", "run"}, path).code == 0);
  CHECK(films_in(folder / "run") == Words{"film.mp4", "film.webp"});
  CHECK(slurp(folder / "run/film.webp") == "made by the stand-in\n");
}

TEST_CASE("mpm film says why there is none", "[film]") {
  const Folder folder;
  const Words path = stand_in(folder);
  const auto refused = [&](const Words& words, int code, const std::string& part) {
    const Result result = call(folder, words, path);
    INFO(result.err);
    CHECK(result.code == code);
    CHECK(has(result.err, part));
  };
  refused({"film", "run"}, 2, "run holds no run (no manifest.json)");
  REQUIRE(run_filmed(folder, false, path, {"--set", "/output/frames=1"}).code == 0);
  refused({"film", "run"}, 2, "run: holds fewer than two frames: set \"frames\" of \"output\"");
  refused({"film", "run", "--format", "gif"}, 2, "gif not in {mp4,webm,webp}");
  REQUIRE(run_filmed(folder, false, path, {"--replace"}).code == 0);
  spill(folder / "bin/ffmpeg", "#!/bin/sh\necho \"Unknown encoder 'libwebp'\" >&2\nexit 1\n");
  refused({"film", "run", "--format", "webp"}, 5, "this ffmpeg was built without the encoder libwebp");
  fs::remove(folder / "bin/ffmpeg");
  refused({"film", "run"}, 5, "no film: ffmpeg is not installed");
  CHECK(films_in(folder / "run").empty());
}

TEST_CASE("the ffmpeg that is installed takes what it is told", "[film]") {
  const Folder folder;
  REQUIRE(run_filmed(folder, false, {}).code == 0);
  const Result result = call(folder, {"film", "run", "--format", "webp"});
  INFO(result.err);
  if (has(result.err, "ffmpeg is not installed") || has(result.err, "built without the encoder")) {
    WARN("no ffmpeg with libwebp is installed: the test of it is left out");
    return;
  }
  CHECK(result.code == 0);
  CHECK(is_animated_webp(slurp(folder / "run/film.webp")));
}
