// `mpm run FILE --resume`: a run that was stopped, killed or had no room goes on bit for bit, and what cannot be
// resumed is refused.

#include <sys/mount.h>
#include <sys/resource.h>

#include <iostream>
#include <random>

#include "cli/program.hpp"
#include "output/checkpoint_file.hpp"
#include "support/files.hpp"
#include "support/processors.hpp"

using namespace mpm::test;
namespace output = mpm::output;

namespace {

/// Two balls that meet, with rows, frames and files of particles that fall between the checkpoints.
Json meeting() {
  Json scene = two_balls();
  scene["output"] = {{"metrics_every", 3}, {"frames", 4}, {"vtk", true}, {"checkpoint_steps", 7}};
  scene["output"]["particles"] = {{"format", {"vtk", "csv"}}, {"count", 5}, {"grid", true}, {"shape", "domains"}};
  return scene;
}

Words files_below(const fs::path& folder) {
  Words names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    names.push_back(entry.path().lexically_relative(folder).string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string all_bytes_below(const fs::path& folder) {
  std::string all;
  for (const std::string& name : files_below(folder))
    if (fs::is_regular_file(folder / name)) all += name + "\n" + slurp(folder / name);
  return all;
}

/// The summary without what depends on the clock and on the memory.
Json numbers_of(const fs::path& run) {
  Json summary = json_in(run / "summary.json");
  summary.erase("performance");
  return summary;
}

/// Checks that every file but those that tell times and commands has the same bytes, and that the folder holds nothing
/// more and nothing less.
void check_same_results(const fs::path& run, const fs::path& whole) {
  INFO(run << " against " << whole);
  const Words names = files_below(whole);
  CHECK(files_below(run) == names);
  for (const std::string& name : names) {
    if (!fs::is_regular_file(whole / name)) continue;
    if (name == "manifest.json" || name == "summary.json" || name == "report.html" || name == "experiment.json")
      continue;
    INFO(name);
    CHECK((slurp(run / name) == slurp(whole / name)));
  }
  CHECK(numbers_of(run).dump() == numbers_of(whole).dump());
}

/// The words that run scene.json into FOLDER/run; pictures name the run folder, so that compared ones share its name.
Words words_for(const std::string& place, Words more = {}) {
  Words words{"run", "scene.json", "--out", place + "/run", "--threads", "1"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Result run_in(const Folder& folder, const std::string& place, Words more = {}) {
  return call(folder, words_for(place, std::move(more)));
}

void must_end_with(int code, const Result& result) {
  INFO(result.err);
  REQUIRE(result.signal == 0);
  REQUIRE(result.code == code);
}

/// Runs until `steps` steps, as if there had been no time for more; the checkpoint of that step and one before are
/// there.
void run_until(const Folder& folder, const std::string& place, int steps, Words more = {}) {
  more.insert(more.end(), {"--set", "/solver/max_steps=" + std::to_string(steps)});
  must_end_with(3, run_in(folder, place, more));
}

/// Checks that --resume refuses bad input: code 2, the parts are said, and no byte of the folder is changed.
void resume_refused(const Folder& folder, const Words& words, const Words& parts) {
  const std::string before = all_bytes_below(folder.path());
  const Result result = call(folder, words);
  INFO(result.err);
  CHECK(result.code == 2);
  for (const std::string& part : parts) {
    INFO("expected: " << part);
    CHECK(has(result.err, part));
  }
  CHECK((all_bytes_below(folder.path()) == before));
}

std::vector<fs::path> checkpoints(const Folder& folder, const std::string& place) {
  return output::checkpoints_in(folder / (place + "/run/checkpoint"));
}

/// Scenes whose particles carry more than a transfer's and a material's own state: coefficients of polynomials,
/// corners.
std::vector<std::pair<std::string, Json>> scenes_that_carry_more() {
  Json polynomials = meeting();
  polynomials["transfer"] = {{"type", "polypic"}, {"basis", "full"}};
  Json corners = meeting();
  corners["shape"]["type"] = "cpdi2";
  corners["transfer"]["type"] = "flip";
  corners["solver"]["stress_update"] = "modified_last";
  return {{"polynomials", polynomials}, {"corners", corners}};
}

/// Scenes that keep different states: contact, one fused pass, filters, node lists, histories, automatic steps.
std::vector<std::pair<std::string, Json>> scenes() {
  std::vector<std::pair<std::string, Json>> all = scenes_that_carry_more();
  Json shown = meeting();
  shown["output"]["contact_nodes"] = true;
  all.emplace_back("contact", shown);
  Json fused = meeting();
  fused.erase("contact");
  fused["bodies"].erase(1);
  fused["transfer"]["type"] = "mls";
  fused["solver"]["time_step"] = "auto";
  all.emplace_back("one body, automatic step", fused);
  Json filtered = meeting();
  filtered["transfer"]["type"] = "flip";
  filtered["filter"] = {{"type", "xpic"}, {"order", 3}, {"every_steps", 3}};
  all.emplace_back("filter with contact", filtered);
  filtered.erase("contact");
  filtered["filter"] = {{"type", "fmpm"}, {"order", 2}, {"every_courant", 0.7}};
  filtered["solver"]["time_step"] = "auto";
  all.emplace_back("filter by courant", filtered);
  Json plastic = meeting();
  plastic["materials"]["m"] = {
      {"type", "von_mises"}, {"youngs_modulus", 1e5}, {"poisson_ratio", 0.3}, {"yield_stress", 100}, {"density", 1000}};
  plastic["shape"]["type"] = "cpdi";
  plastic["transfer"]["type"] = "flip";
  plastic.erase("contact");
  plastic["solver"]["time_step"] = "auto";
  all.emplace_back("plastic, node lists", plastic);
  return all;
}

class SmallDisk {
 public:
  explicit SmallDisk(fs::path at) : path_(std::move(at)) {
    fs::create_directory(path_);
    mounted_ = ::mount("tmpfs", path_.c_str(), "tmpfs", 0, "size=96k") == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount2(path_.c_str(), MNT_DETACH);
  }
  bool mounted() const { return mounted_; }
  bool grow() const { return ::mount("tmpfs", path_.c_str(), "tmpfs", MS_REMOUNT, "size=16m") == 0; }

 private:
  fs::path path_;
  bool mounted_ = false;
};

/// Stops runs at several steps and lets them go on: each scene on so many of three backends and precisions, in turn.
void check_stopped_runs(std::size_t of_three) {
  const std::vector<std::pair<std::string, std::string>> ways{
      {"reference", "double"}, {"cpu", "double"}, {"cpu", "float"}};
  const auto all = scenes();
  for (std::size_t s = 0; s < all.size(); ++s)
    for (std::size_t k = 0; k < of_three; ++k) {
      const auto& [name, scene] = all[s];
      const auto& [backend, precision] = ways[(s + k) % ways.size()];
      INFO(name << ", " << backend << ", " << precision);
      const Folder folder;
      Json variant = scene;
      variant["backend"] = backend;
      variant["precision"] = precision;
      spill(folder / "scene.json", variant.dump(1));
      must_end_with(0, run_in(folder, "whole"));
      const int steps = json_in(folder / "whole/run/summary.json")["steps"];
      REQUIRE(steps > 10);
      run_until(folder, "parts", 1);
      for (const int stop : {steps / 3, steps / 2 + 1, steps - 1}) run_until(folder, "parts", stop, {"--resume"});
      must_end_with(0, run_in(folder, "parts", {"--resume"}));
      check_same_results(folder / "parts/run", folder / "whole/run");
      const Json from = json_in(folder / "parts/run/summary.json")["performance"]["resumed_from_step"];
      CHECK(from == Json{1, steps / 3, steps / 2 + 1, steps - 1});
      const Json manifest = json_in(folder / "parts/run/manifest.json");
      CHECK(manifest["resumed"].size() == 4);
      CHECK(manifest["resumed"][3]["resumed_from_step"] == steps - 1);
    }
}

/// Kills runs at random moments, half of them on each backend; of so many kills a part comes after a checkpoint.
void check_killed_runs(int all_kills, int least_resumed) {
  const unsigned seed = 20240607;
  std::mt19937 random(seed);
  int kills = 0, resumed = 0, runs = 0;
  for (const char* backend : {"cpu", "reference"}) {
    const Folder folder;
    Json scene = meeting();
    scene["backend"] = backend;
    scene["output"]["frames"] = 2;  // drawing takes longer than stepping
    scene["solver"]["end_time"] = 0.4;
    spill(folder / "scene.json", scene.dump(1));
    const Result whole = run_in(folder, "whole");
    must_end_with(0, whole);
    for (const int goal = kills + all_kills / 2; kills < goal; ++runs) {
      const std::string place = "killed" + std::to_string(runs);
      for (bool ended = false; !ended;) {
        const bool goes_on = !checkpoints(folder, place).empty();
        resumed += goes_on;
        Process process(folder, program(words_for(place, goes_on ? Words{"--resume"} : Words{})));
        const double wait = std::uniform_real_distribution<double>(0, whole.seconds)(random);
        if (kills < goal) {  // the last run comes to its end
          std::this_thread::sleep_for(std::chrono::duration<double>(wait));
          process.send(SIGKILL);
        }
        const Result result = process.finish();
        INFO("seed " << seed << ", kill " << kills << " after " << wait << " s\n" << result.err);
        ended = result.signal != SIGKILL;
        kills += !ended;
        if (ended) must_end_with(0, result);
        // A run whose results are whole needs nothing more, even when it was killed while it tidied up.
        if (!ended && fs::exists(folder / (place + "/run/summary.json")) && checkpoints(folder, place).empty()) {
          ended = true;
          fs::remove(folder / (place + "/run/checkpoint/snapshots.records"));
          fs::remove(folder / (place + "/run/checkpoint"));
        }
      }
      check_same_results(folder / (place + "/run"), folder / "whole/run");
    }
  }
  std::cout << "seed " << seed << ": " << kills << " kills, " << resumed << " resumptions, " << runs << " runs\n";
  CHECK(kills >= all_kills);
  CHECK(resumed >= least_resumed);
}

}  // namespace

TEST_CASE("a run that was stopped at any step goes on bit for bit") {
  check_stopped_runs(1);
}

TEST_CASE("a run that was stopped at any step goes on bit for bit on every backend and in both precisions", "[slow]") {
  check_stopped_runs(3);
}

TEST_CASE("thirty kills at random moments change no byte") {
  check_killed_runs(30, 9);
}

TEST_CASE("a hundred kills at random moments change no byte", "[slow]") {
  check_killed_runs(100, 30);
}

TEST_CASE("a killed run goes on with the polynomials and corners that its particles carry") {
  for (const auto& [name, scene] : scenes_that_carry_more())
    for (const char* backend : {"cpu", "reference"}) {
      INFO(name << ", " << backend);
      const Folder folder;
      Json variant = scene;
      variant["backend"] = backend;
      variant["solver"]["time_step"] = 0.0005;
      spill(folder / "scene.json", variant.dump(1));
      must_end_with(0, run_in(folder, "whole"));
      std::vector<fs::path> last;
      for (const bool goes_on : {false, true}) {  // the run is killed as soon as it has come further
        Process process(folder, program(words_for("killed", goes_on ? Words{"--resume"} : Words{})));
        REQUIRE(process.wait_until([&] {
          const std::vector<fs::path> present = checkpoints(folder, "killed");
          return !present.empty() && (last.empty() || present[0].filename() > last[0].filename());
        }));
        process.send(SIGKILL);
        REQUIRE(process.finish().signal == SIGKILL);
        last = checkpoints(folder, "killed");
      }
      must_end_with(0, run_in(folder, "killed", {"--resume"}));
      check_same_results(folder / "killed/run", folder / "whole/run");
      CHECK(json_in(folder / "killed/run/summary.json")["performance"]["resumed_from_step"].size() == 2);
    }
}

TEST_CASE("another number of threads goes on with the same bits") {
  const Folder folder;
  Json scene = meeting();
  scene["grid"]["cell_size"] = 0.02;
  for (Json& body : scene["bodies"]) body["particles_per_cell_axis"] = 4;
  scene["solver"] = {{"time_step", 0.001}, {"end_time", 0.03}};
  scene["output"].erase("frames"), scene["output"].erase("vtk");
  scene["output"].erase("particles");
  scene["output"]["vtk"] = false;
  spill(folder / "scene.json", scene.dump(1));
  must_end_with(0, run_in(folder, "whole"));
  REQUIRE(json_in(folder / "whole/run/summary.json")["particles"].get<int>() > 6000);
  run_until(folder, "parts", 11);
  must_end_with(0, call(folder, {"run", "scene.json", "--out", "parts/run", "--threads", "3", "--resume"}));
  check_same_results(folder / "parts/run", folder / "whole/run");
  CHECK(json_in(folder / "parts/run/manifest.json")["resumed"][0]["threads"] ==
        std::min(3, mpm::support::available_processors()));
}

TEST_CASE("Ctrl-C and a polite kill say how to go on, first of all") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Folder folder;
    Json scene = meeting();
    scene["backend"] = "reference";
    scene["output"]["checkpoint_steps"] = 0;
    scene["solver"]["end_time"] = 1.2;
    spill(folder / "a scene.json", scene.dump(1));
    must_end_with(0, call(folder, {"run", "a scene.json", "--out", "whole/run"}));
    Process process(folder, program({"run", "a scene.json", "--out", "parts/run"}));
    REQUIRE(process.wait_until([&] { return rows_written(folder / "parts/run/metrics.csv", 8); }));
    process.send(signal);
    const Result stopped = process.finish();
    INFO(stopped.err);
    REQUIRE(stopped.code == 130);
    CHECK(checkpoints(folder, "parts").size() == 1);
    const std::string how = "resume with: ./mpm run 'a scene.json' --out parts/run --resume\n";
    REQUIRE(has(stopped.err, how));
    CHECK(stopped.err.find(how) < stopped.err.find("stopped by a signal"));
    const Result resumed = Process(folder, {"/bin/sh", "-c",
                                            "exec '" MPM_BUILD_DIR "/bin/" + how.substr(how.find("mpm"), 3) + "'" +
                                                how.substr(how.find("mpm") + 3)})
                               .finish();
    must_end_with(0, resumed);
    CHECK(has(resumed.err, "resumed from step "));
    check_same_results(folder / "parts/run", folder / "whole/run");
  }
}

TEST_CASE("the seconds of all parts are summed") {
  const Folder folder;
  spill(folder / "scene.json", meeting().dump(1));
  run_until(folder, "parts", 20);
  const Json first = json_in(folder / "parts/run/summary.json")["performance"];
  must_end_with(0, run_in(folder, "parts", {"--resume"}));
  const Json both = json_in(folder / "parts/run/summary.json")["performance"];
  for (const auto& [pass, seconds] : first["seconds_by_pass"].items())
    CHECK(both["seconds_by_pass"][pass].get<double>() > seconds.get<double>());
  CHECK(both["stepping_seconds"].get<double>() > first["stepping_seconds"].get<double>());
}

TEST_CASE("a damaged checkpoint is never used: the one before is, and with none left nothing is touched") {
  const Folder folder;
  spill(folder / "scene.json", meeting().dump(1));
  must_end_with(0, run_in(folder, "whole"));
  run_until(folder, "parts", 25);
  const auto paths = checkpoints(folder, "parts");
  REQUIRE(paths.size() == 2);
  CHECK(paths[0].filename() == "step_000000000025.checkpoint");
  CHECK(paths[1].filename() == "step_000000000021.checkpoint");
  const std::string newest = slurp(paths[0]), older = slurp(paths[1]);
  fs::copy(folder / "parts", folder / "pristine", fs::copy_options::recursive);

  const auto flipped = [](std::string bytes, std::size_t at) {
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    return bytes;
  };
  std::vector<std::pair<std::string, std::string>> damages{
      {newest.substr(0, newest.size() / 2), "is cut short"},
      {newest.substr(0, 50), "is cut short"},
      {"", "is cut short"},
      {"a letter to a friend about a run", "is not a checkpoint of this program"},
      {newest + "x", "its length is not the one it names"},
      {flipped(newest, 3), "is not a checkpoint of this program"},
      {flipped(newest, 16), "has format 17; this program reads format 1"},
      {flipped(newest, 20), "another order of bytes"},
      {flipped(newest, 60), "does not match its SHA-256"}};
  for (const std::size_t at : {std::size_t{110}, newest.size() / 2, newest.size() - 1})
    damages.emplace_back(flipped(newest, at), "does not match its SHA-256");
  for (const auto& [bytes, reason] : damages) {
    INFO(reason);
    spill(paths[0], bytes);
    spill(paths[1], "");
    resume_refused(folder, words_for("parts", {"--resume"}),
                   {paths[0].filename().string(), reason, "start anew with --replace in place of --resume"});
    spill(paths[1], older);
    const Result result = run_in(folder, "parts", {"--resume"});
    must_end_with(0, result);
    CHECK(has(result.err, "warning: "));
    CHECK(has(result.err, reason));
    CHECK(has(result.err, "the one before is used, step_000000000021.checkpoint"));
    check_same_results(folder / "parts/run", folder / "whole/run");
    fs::remove_all(folder / "parts");
    fs::copy(folder / "pristine", folder / "parts", fs::copy_options::recursive);
  }
}

TEST_CASE("a checkpoint does not go with rows or snapshots that are no longer there") {
  const Folder folder;
  spill(folder / "scene.json", meeting().dump(1));
  run_until(folder, "parts", 25);
  const fs::path run = folder / "parts/run";
  const auto refused_with = [&](const fs::path& file, const std::string& bytes, const std::string& reason) {
    const std::string kept = slurp(file);
    spill(file, bytes);
    resume_refused(folder, words_for("parts", {"--resume"}), {file.filename().string() + " " + reason});
    spill(file, kept);
  };
  const std::string rows = slurp(run / "metrics.csv"), records = slurp(run / "checkpoint/snapshots.records");
  refused_with(run / "metrics.csv", rows.substr(0, rows.size() / 4), "does not hold the rows written before");
  refused_with(run / "metrics.csv", "", "does not hold the rows written before");
  refused_with(run / "checkpoint/snapshots.records", records.substr(0, records.size() / 4), "is cut short");
  refused_with(run / "checkpoint/snapshots.records", "x" + records.substr(1), "is damaged: record 1");
  fs::remove(run / "checkpoint/snapshots.records");
  resume_refused(folder, words_for("parts", {"--resume"}), {"snapshots.records is missing"});
}

TEST_CASE("a checkpoint of another program, plugin or experiment is refused by name") {
  const Folder folder;
  spill(folder / "scene.json", meeting().dump(1));
  run_until(folder, "parts", 25);
  const fs::path newest = checkpoints(folder, "parts")[0];
  const std::string bytes = slurp(newest);
  const output::CheckpointFile file = output::read_checkpoint(newest);
  const auto refused_with = [&](const char* pointer, const Json& value, const Words& parts) {
    Json identity = file.identity;
    identity[Json::json_pointer(pointer)] = value;
    output::write_checkpoint(newest, identity, file.state);
    resume_refused(folder, words_for("parts", {"--resume"}), parts);
    spill(newest, bytes);
  };
  refused_with("/version", "0.0.1", {"was written by version 0.0.1", "resume with that version"});
  refused_with("/plugins/1/file_sha256", std::string(64, '0'),
               {"plugin \"apic\" is not the one that wrote", "SHA-256 000000000000", "put that one back"});
  refused_with("/experiment/transfer/type", "pic", {"/transfer/type: is \"apic\", and \"pic\" in the run in"});
  output::write_checkpoint(newest, file.identity, std::string_view(file.state).substr(0, 300));
  resume_refused(folder, words_for("parts", {"--resume"}),
                 {"is whole but holds another state than this program keeps"});
}

TEST_CASE("a run goes on with another backend from the same state") {
  const Folder folder;
  Json scene = meeting();
  scene["output"].erase("frames"), scene["output"].erase("vtk");
  spill(folder / "scene.json", scene.dump(1));
  const auto end_of = [&](const std::string& place) {
    return json_in(folder / (place + "/run/summary.json"))["energy"]["total"]["final"].get<double>();
  };
  must_end_with(0, run_in(folder, "whole"));
  const int steps = json_in(folder / "whole/run/summary.json")["steps"];
  const Words cuda{"--resume", "--backend", "cuda", "--device", "host"}, cpu{"--resume", "--backend", "cpu"},
      reference{"--resume", "--backend", "reference"};
  run_until(folder, "parts", steps / 4);
  run_until(folder, "parts", steps / 2, cuda);
  run_until(folder, "parts", 3 * steps / 4, reference);
  must_end_with(0, run_in(folder, "parts", cpu));
  CHECK(json_in(folder / "parts/run/summary.json")["performance"]["resumed_from_step"] ==
        Json{steps / 4, steps / 2, 3 * steps / 4});
  CHECK(std::abs(end_of("parts") / end_of("whole") - 1) < 1e-11);
  CHECK(files_below(folder / "parts/run") == files_below(folder / "whole/run"));
  const Json manifest = json_in(folder / "parts/run/manifest.json");
  REQUIRE(manifest["resumed"].size() == 3);
  CHECK(has(manifest["resumed"][0]["command"], "--backend cuda --device host"));

  // Without --resume it is another run: what it would replace has other numbers.
  const Result anew = run_in(folder, "parts", {"--backend", "reference"});
  CHECK(anew.code == 2);
  CHECK(has(anew.err, "/backend is \"cpu\" there, and \"reference\" here"));
}

TEST_CASE("a run with deterministic sums of a device goes on without them, and on a backend that has none") {
  const Folder folder;
  Json scene = meeting();
  scene["output"].erase("frames"), scene["output"].erase("vtk");
  scene["backend"] = "cuda", scene["device"] = {{"sums", "deterministic"}};
  spill(folder / "scene.json", scene.dump(1));
  const Words host{"--device", "host"}, fast{"--resume", "--device", "host", "--set", "/device/sums=fast"};
  run_until(folder, "parts", 10, host);
  run_until(folder, "parts", 20, fast);
  const Words refused{"--resume", "--backend", "cpu"};
  const Result kept = run_in(folder, "parts", refused);
  CHECK(kept.code == 2);
  CHECK(has(kept.err, "\"device\" says how backend \"cuda\" works, and the backend is \"cpu\""));
  must_end_with(0, run_in(folder, "parts", {"--resume", "--backend", "cpu", "--set", "/device=null"}));
  CHECK(json_in(folder / "parts/run/summary.json")["performance"]["resumed_from_step"] == Json{10, 20});
}

TEST_CASE("another experiment is refused, with the first difference") {
  const Folder folder;
  spill(folder / "scene.json", meeting().dump(1));
  run_until(folder, "parts", 25);
  const auto refused_with = [&](Words more, const Words& parts) {
    more.insert(more.begin(), "--resume");
    resume_refused(folder, words_for("parts", more), parts);
  };
  refused_with({"--set", "/bodies/1/velocity=[-2, -1]"}, {"/bodies/1/velocity/0: is -2", "and -1", "--set"});
  refused_with({"--set", "/output/metrics_every=4"}, {"/output/metrics_every: is 4, and 3 in the run in"});
  refused_with({"--set", "/precision=float"}, {"/precision: is \"float\", and \"double\""});
  Json changed = meeting();
  changed["contact"]["friction"] = 0.4;
  spill(folder / "scene.json", changed.dump(1));
  refused_with({},
               {"scene.json:", "/contact/friction: is 0.4, and 0.3 in the run in", "experiment.json holds them all"});

  // A key that acts at the end only may have another value.
  Json free = meeting();
  free["title"] = "The same";
  free["figures"] = {"energy"};
  free["output"]["checkpoint_steps"] = 1;
  free["compare"]["expect"] = Json::array({{{"metric", "steps"}, {"at_least", 1}}});
  spill(folder / "scene.json", free.dump(1));
  must_end_with(0, run_in(folder, "whole"));
  must_end_with(0, run_in(folder, "parts", {"--resume"}));
  check_same_results(folder / "parts/run", folder / "whole/run");
  CHECK(json_in(folder / "parts/run/experiment.json")["title"] == "The same");
}

TEST_CASE("a finished run is left as it is; what is no run is refused") {
  const Folder folder;
  spill(folder / "scene.json", meeting().dump(1));
  must_end_with(0, run_in(folder, "parts"));
  CHECK(!fs::exists(folder / "parts/run/checkpoint"));
  const std::string before = all_bytes_below(folder.path());
  const Result again = run_in(folder, "parts", {"--resume"});
  must_end_with(0, again);
  CHECK(has(again.err, "holds a finished run (exit code 0): nothing was left to do"));
  CHECK((all_bytes_below(folder.path()) == before));
  resume_refused(folder, words_for("parts", {"--resume", "--set", "/solver/end_time=0.1"}),
                 {"/solver/end_time: is 0.1, and 0.08"});

  spill(folder / "scene.json", expecting(meeting(), {{"metric", "steps"}, {"at_least", 1000}}).dump(1));
  must_end_with(4, run_in(folder, "failing"));
  CHECK(!fs::exists(folder / "failing/run/checkpoint"));
  must_end_with(4, run_in(folder, "failing", {"--resume"}));

  resume_refused(folder, words_for("nowhere", {"--resume"}), {"holds no run (no manifest.json)", "without --resume"});
  resume_refused(folder, {"run", "scene.json", "--resume"}, {"runs/scene holds no run"});
  fs::create_directories(folder / "early/run");
  fs::copy(folder / "parts/run/manifest.json", folder / "early/run/manifest.json");
  resume_refused(folder, words_for("early", {"--resume"}), {"holds no checkpoint", "start it anew without --resume"});
}

TEST_CASE("a failed run keeps its last checkpoint and fails in the same way again") {
  const Folder folder;
  Json scene = meeting();
  scene["body_force"] = {"sqrt(0.05 - t)", 0};
  spill(folder / "scene.json", scene.dump(1));
  const Result first = run_in(folder, "parts");
  must_end_with(3, first);
  CHECK(checkpoints(folder, "parts").size() == 2);
  const std::string reason = numbers_of(folder / "parts/run")["outcome"]["reason"];
  const std::string rows = slurp(folder / "parts/run/metrics.csv");
  must_end_with(3, run_in(folder, "parts", {"--resume"}));
  CHECK(numbers_of(folder / "parts/run")["outcome"]["reason"] == reason);
  CHECK((slurp(folder / "parts/run/metrics.csv") == rows));
}

TEST_CASE("one program a run folder") {
  const Folder folder;
  spill(folder / "scene.json", endless_ball().dump(1));
  Process process(folder, program({"run", "scene.json", "--out", "run", "--threads", "1"}));
  REQUIRE(process.wait_until([&] { return rows_written(folder / "run/metrics.csv", 3); }));
  // The second process lies beside the first one's streams: Process has one pair of files a folder.
  const Folder other;
  for (const Words& more : {Words{}, Words{"--resume"}}) {
    Words words{"run", folder / "scene.json", "--out", folder / "run"};
    words.insert(words.end(), more.begin(), more.end());
    const Result result = call(other, words);
    INFO(result.err);
    CHECK(result.code == 2);
    CHECK(has(result.err, "is being written by another mpm that still runs"));
  }
  process.send(SIGTERM);
  CHECK(process.finish().code == 130);
}

TEST_CASE("no room for a checkpoint costs neither the run nor the checkpoint before") {
  const Folder folder;
  Json scene = meeting();
  scene["backend"] = "reference";
  scene["output"] = {{"metrics_every", 1000000}, {"checkpoint_steps", 5}};
  scene["solver"]["end_time"] = 4.0;
  spill(folder / "scene.json", scene.dump(1));
  must_end_with(0, run_in(folder, "whole"));
  for (const bool room_again : {false, true}) {
    INFO(room_again);
    const std::string place = room_again ? "grown" : "killed";
    Process process(folder, program(words_for(place)));
    REQUIRE(process.wait_until([&] { return checkpoints(folder, place).size() == 2; }));
    rlimit before{};
    REQUIRE(::prlimit(process.id(), RLIMIT_FSIZE, nullptr, &before) == 0);
    rlimit small = before;
    small.rlim_cur = 4096;
    REQUIRE(::prlimit(process.id(), RLIMIT_FSIZE, &small, nullptr) == 0);
    REQUIRE(process.wait_until(
        [&] { return has(slurp(folder.stream("err")), "warning: a checkpoint could not be written: "); }));
    CHECK(has(slurp(folder.stream("err")), "File too large; raise the limit on file size"));
    CHECK(!checkpoints(folder, place).empty());
    output::read_checkpoint(checkpoints(folder, place)[0]);
    if (room_again) {
      REQUIRE(::prlimit(process.id(), RLIMIT_FSIZE, &before, nullptr) == 0);
      const Result result = process.finish();
      must_end_with(0, result);
      CHECK(has(result.err, "checkpoints are written again"));
      CHECK(has(json_in(folder / "grown/run/summary.json")["warnings"].dump(), "a checkpoint could not be written"));
      CHECK((slurp(folder / "grown/run/metrics.csv") == slurp(folder / "whole/run/metrics.csv")));
    } else {
      process.send(SIGKILL);
      CHECK(process.finish().signal == SIGKILL);
      must_end_with(0, run_in(folder, place, {"--resume"}));
      check_same_results(folder / "killed/run", folder / "whole/run");
    }
  }
}

TEST_CASE("no room for results: code 5, and the run goes on where there is room") {
  const Folder folder;
  Json scene = ball();
  scene["backend"] = "reference";
  scene["output"] = {{"metrics_every", 1}, {"checkpoint_steps", 50}};
  scene["solver"]["end_time"] = 2.0;
  spill(folder / "scene.json", scene.dump(1));
  must_end_with(0, run_in(folder, "whole"));
  const std::string command =
      "ulimit -f 256; exec '" MPM_BUILD_DIR "/bin/mpm' run scene.json --out limited/run --threads 1";  // of 512 bytes
  const Result limited = Process(folder, {"/bin/sh", "-c", command}).finish();
  must_end_with(5, limited);
  CHECK(has(limited.err, "metrics.csv: File too large"));
  CHECK(has(limited.err, "resume with: ./mpm run scene.json --out limited/run --threads 1 --resume"));
  must_end_with(0, run_in(folder, "limited", {"--resume"}));
  check_same_results(folder / "limited/run", folder / "whole/run");

  const SmallDisk disk(folder / "disk");
  if (!disk.mounted()) {
    WARN("no small disk could be mounted: the test of a full one is left out");
    return;
  }
  must_end_with(5, run_in(folder, "disk"));
  REQUIRE(disk.grow());
  must_end_with(0, run_in(folder, "disk", {"--resume"}));
  check_same_results(folder / "disk/run", folder / "whole/run");
}
