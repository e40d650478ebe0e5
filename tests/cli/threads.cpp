// How many threads a run and a study take, what they write of it, and that no bit of a result depends on it.

#include <sched.h>

#include "cli/program.hpp"
#include "support/processors.hpp"

using namespace mpm::test;

namespace {

/// Two balls of 5000 particles each, which several threads share, for 20 steps.
Json fine_balls() {
  Json scene = two_balls();
  scene["grid"]["cell_size"] = 0.01;
  scene["solver"] = {{"time_step", 0.0005}, {"end_time", 0.01}};
  scene["output"]["metrics_every"] = 1;
  return scene;
}

void run_as(const Folder& folder, const std::string& place, Words more, const Words& environment = {}) {
  Words words{"run", "scene.json", "--out", place};
  words.insert(words.end(), more.begin(), more.end());
  const Result result = call(folder, words, environment);
  INFO(result.err);
  REQUIRE(result.code == 0);
}

/// Limits what is started within this scope to one processor.
class OneProcessor {
 public:
  OneProcessor() {
    REQUIRE(::sched_getaffinity(0, sizeof before_, &before_) == 0);
    int processor = 0;
    while (!CPU_ISSET(processor, &before_)) ++processor;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    REQUIRE(::sched_setaffinity(0, sizeof one, &one) == 0);
  }
  ~OneProcessor() { ::sched_setaffinity(0, sizeof before_, &before_); }

 private:
  cpu_set_t before_{};
};

}  // namespace

TEST_CASE("a run takes at most one thread a processor, and the same bytes come of any number") {
  const int processors = mpm::support::available_processors();
  const Folder folder;
  spill(folder / "scene.json", fine_balls().dump(1));
  run_as(folder, "one", {"--threads", "1"});
  const std::string metrics = slurp(folder / "one/metrics.csv");
  run_as(folder, "default", {});
  CHECK(json_in(folder / "default/manifest.json")["threads"] == processors);
  CHECK(json_in(folder / "default/manifest.json")["processors"] == processors);
  CHECK(slurp(folder / "default/metrics.csv") == metrics);

  const Result many = call(folder, {"run", "scene.json", "--out", "many", "--threads", "1000"});
  CHECK(many.code == 0);
  CHECK(has(many.err, "--threads 1000: this process may use " + std::to_string(processors) + " processor"));
  CHECK(json_in(folder / "many/manifest.json")["threads"] == processors);
  CHECK(slurp(folder / "many/metrics.csv") == metrics);
}

TEST_CASE("a run that may use one processor takes one thread") {
  const Folder folder;
  spill(folder / "scene.json", fine_balls().dump(1));
  run_as(folder, "free", {"--threads", "1"});
  const OneProcessor one;
  for (const Words& more : {Words{}, Words{"--threads", "64"}}) {
    const std::string place = more.empty() ? "default" : "many";
    run_as(folder, place, more);
    CHECK(json_in(folder / place / "manifest.json")["threads"] == 1);
    CHECK(json_in(folder / place / "manifest.json")["processors"] == 1);
    CHECK(slurp(folder / place / "metrics.csv") == slurp(folder / "free/metrics.csv"));
  }
}

TEST_CASE("threads that wait sleep after a millisecond at most, or as the environment says") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump(1));
  const char* const before = std::getenv("OMP_WAIT_POLICY");
  const std::string policy = before ? before : "";
  ::unsetenv("OMP_WAIT_POLICY");
  run_as(folder, "standard", {});
  const double spin = json_in(folder / "standard/manifest.json")["longest_spin_us"];
  CHECK(spin > 0);
  CHECK(spin <= 1000);
  run_as(folder, "passive", {}, {"OMP_WAIT_POLICY=passive"});
  CHECK(json_in(folder / "passive/manifest.json")["longest_spin_us"] == 0);
  if (before) ::setenv("OMP_WAIT_POLICY", policy.c_str(), 1);
}

TEST_CASE("runs of a study share the processors") {
  const Folder folder;
  spill(folder / "scene.json", ball().dump(1));
  spill(folder / "study.json", R"({"base": "scene.json", "axes": {"/transfer/type": ["pic", "flip"]}})");
  const OneProcessor one;
  const Result result = call(folder, {"study", "study.json", "--out", "out", "--jobs", "2", "--threads", "3"});
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(has(result.err, "each run has 1 thread, not 3: 2 runs at a time on 1 processor"));
  for (const char* run : {"pic", "flip"}) CHECK(json_in(folder / "out/runs" / run / "manifest.json")["threads"] == 1);
}
