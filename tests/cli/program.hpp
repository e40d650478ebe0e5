#pragma once
// The built program as a person runs it: a process of its own in a fresh folder, its two streams and its exit code.

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/temporary_folder.hpp"

namespace mpm::test {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

inline std::string slurp(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void spill(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// The JSON of a file. Fails the test when the file does not hold whole JSON.
inline Json json_in(const fs::path& path) {
  INFO(path);
  REQUIRE(fs::is_regular_file(path));
  Json value = Json::parse(slurp(path), nullptr, false);
  REQUIRE(!value.is_discarded());
  return value;
}

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A fresh folder, removed at the end. The program's streams lie outside of it.
class Folder {
 public:
  Folder() { fs::create_directory(path()); }

  fs::path path() const { return root_ / "work"; }
  fs::path operator/(const fs::path& name) const { return path() / name; }
  fs::path stream(const char* name) const { return root_ / name; }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(path())) found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  TemporaryFolder root_;
};

struct Result {
  int code = -1;   ///< exit code; -1 when a signal ended it
  int signal = 0;  ///< that signal
  double seconds = 0;
  double processor_seconds = 0;  ///< seconds that other programs do not lengthen
  std::string out, err;
};

/// A process that goes on; killed when it is still there at the end of the scope.
class Process {
 public:
  Process(const Folder& folder, const Words& words, const Words& environment = {})
      : folder_(folder), start_(std::chrono::steady_clock::now()) {
    std::vector<std::string> variables(environment);
    for (char** entry = environ; *entry; ++entry)
      if (!std::string(*entry).starts_with("MPM_PLUGIN_PATH=")) variables.emplace_back(*entry);
    std::vector<std::string> copy(words);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder.path().c_str());
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, folder.stream("out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    posix_spawn_file_actions_addopen(&actions, 2, folder.stream("err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t standard;
    sigfillset(&standard);
    posix_spawnattr_setsigdefault(&attributes, &standard);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const int error =
        posix_spawn(&id_, copy[0].c_str(), &actions, &attributes, pointers(copy).data(), pointers(variables).data());
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) throw std::runtime_error("cannot start " + words[0]);
  }
  ~Process() {
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    ::waitpid(id_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t id() const { return id_; }
  void send(int signal) const { ::kill(id_, signal); }

  /// Waits until `ready` holds; false when the process ended or five minutes passed before, which are enough for a busy
  /// machine.
  bool wait_until(const std::function<bool()>& ready) const {
    const auto late = std::chrono::steady_clock::now() + std::chrono::minutes(5);
    while (std::chrono::steady_clock::now() < late) {
      if (ready()) return true;
      siginfo_t state{};
      if (waitid(P_PID, static_cast<id_t>(id_), &state, WEXITED | WNOHANG | WNOWAIT) == 0 && state.si_pid == id_)
        return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }

  Result finish() {
    int status = 0;
    rusage usage{};
    ::wait4(id_, &status, 0, &usage);
    id_ = -1;
    Result result;
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    for (const timeval& time : {usage.ru_utime, usage.ru_stime})
      result.processor_seconds += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    result.out = slurp(folder_.stream("out"));
    result.err = slurp(folder_.stream("err"));
    return result;
  }

 private:
  static std::vector<char*> pointers(std::vector<std::string>& words) {
    std::vector<char*> list;
    for (std::string& word : words) list.push_back(word.data());
    list.push_back(nullptr);
    return list;
  }

  const Folder& folder_;
  std::chrono::steady_clock::time_point start_;
  pid_t id_ = -1;
};

inline Words program(Words words) {
  words.insert(words.begin(), MPM_BUILD_DIR "/bin/mpm");
  return words;
}

inline Result call(const Folder& folder, const Words& words, const Words& environment = {}) {
  return Process(folder, program(words), environment).finish();
}

/// One elastic ball that flies: 52 particles, 50 steps, no pictures. Tests change what they are about.
inline Json ball() {
  return Json::parse(R"({
    "title": "A ball", "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "slip"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "mls"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": [0.5, 0.5], "radius": 0.2},
                "seeding": "lattice", "velocity": [0.1, 0.1]}],
    "solver": {"time_step": 0.002, "end_time": 0.1}, "output": {"metrics_every": 5}
  })");
}

/// The ball at a temperature, K, which is a number or an expression.
inline Json warm_ball(const Json& temperature = 300) {
  Json scene = ball();
  scene["materials"]["m"]["thermal"] = {{"conductivity", 1}, {"heat_capacity", 10}};
  scene["bodies"][0]["temperature"] = temperature;
  return scene;
}

/// The ball and a second one that it meets.
inline Json two_balls() {
  Json scene = ball();
  scene["title"] = "Two balls";
  scene["grid"]["cell_size"] = 0.05;
  scene["transfer"]["type"] = "apic";
  scene["contact"] = {{"type", "coulomb"}, {"friction", 0.3}};
  scene["bodies"][0]["geometry"]["centre"] = {0.3, 0.3};
  scene["bodies"][0]["velocity"] = {1.0, 1.0};
  Json other = scene["bodies"][0];
  other["name"] = "other";
  other["geometry"]["centre"] = {0.6, 0.6};
  other["velocity"] = {-1.0, -1.0};
  scene["bodies"].push_back(other);
  scene["solver"]["end_time"] = 0.08;
  return scene;
}

/// The ball with so many steps that it runs on for minutes, with a row a step.
inline Json endless_ball() {
  Json scene = ball();
  scene["solver"]["end_time"] = 1e5;
  scene["output"]["metrics_every"] = 1;
  return scene;
}

inline Json expecting(Json scene, Json expectation) {
  scene["compare"]["expect"].push_back(std::move(expectation));
  return scene;
}

/// Writes the scene as scene.json and runs it on one thread into `run`, in place of what ran there before.
inline Result run_scene(const Folder& folder, const Json& scene, Words more = {}) {
  spill(folder / "scene.json", scene.dump(1));
  Words words{"run", "scene.json", "--out", "run", "--threads", "1"};
  if (fs::exists(folder / "run/manifest.json")) words.emplace_back("--replace");
  words.insert(words.end(), more.begin(), more.end());
  return call(folder, words);
}

/// Runs a scene that stops with code 3, of which summary and report tell. Returns the summary's reason and standard
/// error.
inline std::pair<std::string, std::string> stopped_scene(const Folder& folder, const Json& scene) {
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  CHECK(result.code == 3);
  const Json summary = json_in(folder / "run/summary.json");
  CHECK(summary["outcome"]["exit_code"] == 3);
  CHECK(summary["outcome"]["status"] == "failed");
  const std::string reason = summary["outcome"]["reason"];
  CHECK(has(result.err, reason));
  const std::string report = slurp(folder / "run/report.html");
  CHECK(has(report, "</html>"));
  const Json& outcome = summary["outcome"];
  CHECK(has(report, outcome["cause"].get<std::string>()));
  const Json& where = outcome["where"];
  for (const std::string& place :
       {"step " + where["step"].dump(), "particle " + where["particle"].dump() + " of body " + where["body"].dump()})
    CHECK(has(reason, place));
  CHECK(where["time"].is_number());
  CHECK(where["position"].size() >= 2);
  for (const Json& row : outcome["values"]) CHECK((row["name"].is_string() && row["unit"].is_string()));
  CHECK(has(result.err, "remedy: " + outcome["remedy"].get<std::string>()));
  return {reason, result.err};
}

inline bool rows_written(const fs::path& csv, int least) {
  const std::string text = slurp(csv);
  return std::count(text.begin(), text.end(), '\n') > least;
}

}  // namespace mpm::test
