// A device that is lost in the middle of `mpm run`: what was written stays, and the run goes on from its checkpoint.

#include <cstdlib>
#include <iostream>

#include "backends/device/drivers/host_driver.hpp"
#include "cli/program.hpp"
#include "device/device_support.hpp"
#include "mpm/cli.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Calls the program's command line in this process, where failures can be injected. Returns code and standard error.
std::pair<int, std::string> call_here(const Words& words) {
  std::vector<std::string> all{"mpm"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  std::ostringstream out, err;
  std::streambuf *const usual_out = std::cout.rdbuf(out.rdbuf()), *const usual_err = std::cerr.rdbuf(err.rdbuf());
  const int code = app::run_command_line(static_cast<int>(arguments.size()), arguments.data());
  std::cout.rdbuf(usual_out), std::cerr.rdbuf(usual_err);
  return {code, err.str()};
}

/// Twenty steps with a row each and a checkpoint after every fifth.
std::string scene() {
  Json json = Json::parse(Mix{}.text());
  json["solver"] = {{"time_step", 0.005}, {"end_time", 0.1}};
  json["output"] = {{"metrics_every", 1}, {"checkpoint_steps", 5}};
  return json.dump();
}

}  // namespace

TEST_CASE("a run whose device is lost keeps its rows and goes on from its checkpoint", "[device][driver]") {
  const Folder folder;
  setenv("MPM_CACHE", (folder / "cache").c_str(), 1);
  device_setup();
  spill(folder / "scene.json", scene());
  const auto run = [&](const std::string& out, const Words& more) {
    Words words{"run", (folder / "scene.json").string(), "--out", (folder / out).string()};
    words.insert(words.end(), {"--backend", "cuda", "--device", "host"});
    words.insert(words.end(), more.begin(), more.end());
    return call_here(words);
  };
  const std::vector<std::string> functions{"cuLaunchKernel", "cuStreamSynchronize"};
  std::map<std::string, long> calls;
  for (const std::string& function : functions) calls[function] = -device::calls_on_host(function);
  const auto [done, whole] = run("whole", {});
  INFO(whole);
  REQUIRE(done == 0);
  CHECK(has(whole, "compiling the kernels of this scene (2-D double:"));
  for (const std::string& function : functions) calls[function] += device::calls_on_host(function);

  for (const std::string& function : functions) {
    INFO(function);
    device::fail_on_host(function, calls[function] * 7 / 10, device::driver_launch_failed);
    const auto [code, message] = run(function, {});
    device::forget_failures_on_host();
    INFO(message);
    CHECK(code == 5);
    CHECK(!has(message, "compiling"));  // the cache has it
    CHECK(has(message, "the device failed: device 0 (host) failed "));
    CHECK(has(message, "CUDA_ERROR_LAUNCH_FAILED"));
    CHECK(has(message, "resume with: "));
    const fs::path lost = folder / function;
    const Json summary = json_in(lost / "summary.json");
    CHECK(summary["outcome"]["exit_code"] == 5);
    CHECK(summary["steps"].get<int>() > 5);
    CHECK(summary["steps"].get<int>() < 20);
    CHECK(has(slurp(folder / "whole/metrics.csv"), slurp(lost / "metrics.csv")));
    CHECK(!fs::is_empty(lost / "checkpoint"));

    const auto [resumed, words] = run(function, {"--resume"});
    INFO(words);
    CHECK(resumed == 0);
    CHECK(slurp(lost / "metrics.csv") == slurp(folder / "whole/metrics.csv"));
  }
  unsetenv("MPM_CACHE");
}
