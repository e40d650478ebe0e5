// Run folders, the manifest and values of a summary.
#include <unistd.h>
#include <cmath>
#include <cstring>

#include "output/manifest.hpp"
#include "output/run_folder.hpp"
#include "output/summary_value.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "unit/output_support.hpp"

namespace fs = std::filesystem;
using namespace mpm::output;
using namespace mpm::output::testing;
using namespace mpm::support;

TEST_CASE("a run folder is made with those above it, and replaced file by file", "[output][folder]") {
  const TemporaryFolder scratch;
  const fs::path path = scratch / "runs/first/";
  CHECK(!RunFolder::holds_run(path));
  const RunFolder first = RunFolder::create(path);
  CHECK(first.root().filename() == "first");
  first.write_json("manifest.json", {{"run", 1}});
  CHECK(RunFolder::holds_run(path));
  for (const char* name : {"experiment.json", "plan.json", "summary.json", "metrics.csv", "report.html", "film.mp4",
                           "film.webm", "film.webp"})
    write_atomically(first.root() / name, "old");
  write_atomically(first.frames() / "frame.png", "picture");
  for (const fs::path& folder : {first.figures(), first.vtk(), first.particles(), first.checkpoint()})
    write_atomically(folder / "old", "old");
  write_atomically(first.root() / ".metrics.csv.123.tmp", "half a file");
  write_atomically(first.root() / "notes.txt", "a person's");
  const std::string message = message_of<FolderRefused>([&] { RunFolder::create(path); });
  CHECK(contains(message, "holds an earlier run; replace it with --replace, or choose another folder with --out"));
  const RunFolder second = RunFolder::replace(path);
  CHECK(entries_in(second.root()) == 2);
  CHECK(read_file(second.root() / "notes.txt") == "a person's");
  CHECK(contains(read_file(second.root() / "manifest.json"), "1"));
  CHECK_THROWS_AS(RunFolder::replace(scratch / "runs"), FolderRefused);
}

TEST_CASE("a folder with other contents is refused with a remedy and left alone", "[output][folder]") {
  const TemporaryFolder scratch;
  fs::create_directory(scratch / "thesis");
  write_atomically(scratch / "thesis/chapter.tex", "years of work");
  const std::string message = message_of<FolderRefused>([&] { RunFolder::create(scratch / "thesis"); });
  CHECK(contains(message, "thesis"));
  CHECK(contains(message, "--out"));
  CHECK(read_file(scratch / "thesis/chapter.tex") == "years of work");
  CHECK_THROWS_AS(RunFolder::create(scratch / "thesis/chapter.tex"), FolderRefused);
  CHECK_THROWS_AS(RunFolder::create(scratch / "thesis/chapter.tex/run"), MachineError);
  CHECK_THROWS_AS(RunFolder::open(scratch / "thesis"), FolderRefused);
  fs::create_directories(scratch / "empty/figures");
  CHECK_NOTHROW(RunFolder::create(scratch / "empty"));
}

TEST_CASE("JSON files are readable, and bad bytes or NaN do not lose them", "[output][folder]") {
  const TemporaryFolder scratch;
  const RunFolder run = RunFolder::create(scratch / "run");
  run.write_json("manifest.json", {{"z", 1}, {"a", std::nan("")}, {"title", "bad \xFF byte"}});
  const auto value = nlohmann::ordered_json::parse(read_file(run.root() / "manifest.json"));
  CHECK(value.begin().key() == "z");
  CHECK(value["a"].is_null());
  CHECK(RunFolder::open(run.root()).root() == run.root());
}

TEST_CASE("the machine is described without names or paths", "[output][manifest]") {
  const auto machine = machine_description();
  CHECK(machine.at("cores").get<int>() >= 1);
  CHECK(machine.at("memory_bytes").get<double>() > 1e8);
  CHECK(contains(machine.at("compiler").get<std::string>(), "."));
  CHECK(machine.contains("build_type"));
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  const std::string text = machine.dump();
  CHECK_FALSE(contains(text, "/home"));
  if (std::strlen(host) > 3) CHECK_FALSE(contains(text, host));
}

TEST_CASE("values of a summary by pointer and by path", "[output]") {
  const Json json{{"error", {{"position", {{"rms", 0.25}}}}}, {"word", "x"}};
  CHECK(number_at(json, "/error/position/rms") == 0.25);
  CHECK(number_at(json, "error.position.rms") == 0.25);
  for (const char* path : {"/error/velocity", "/word", "error.position", "/error/~", "", "/"})
    CHECK(std::isnan(number_at(json, path)));
  REQUIRE(value_at(json, "word"));
  CHECK(*value_at(json, "word") == "x");
  CHECK(!value_at(json, "error.velocity"));
}
