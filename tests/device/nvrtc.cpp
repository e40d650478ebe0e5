// The composed text goes through NVIDIA's run-time compiler, to machine code; no GPU is needed.

#include "backends/device/drivers/nvrtc.hpp"

#include <atomic>
#include <thread>

#include "device/covering.hpp"
#include "device/formula_scenes.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

device::Composition composition_of(const Mix& mix, const std::string& precision, std::vector<std::string> more = {}) {
  more.insert(more.end(), mix.overrides.begin(), mix.overrides.end());
  return device::compose(device_choice_of(device_experiment(mix.text(), precision, more)));
}

/// Compiles all, a few of them for an older architecture, and looks for every entry.
void check_that_they_compile(const device::Nvrtc& nvrtc, const std::vector<device::Composition>& compositions) {
  std::vector<device::Cubin> cubins(compositions.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t k = next++; k < compositions.size(); k = next++)
      cubins[k] = nvrtc.compile(compositions[k], k % 8 == 0 ? "sm_80" : "sm_90");
  };
  std::thread other(work);
  work();
  other.join();
  for (std::size_t k = 0; k < compositions.size(); ++k) {
    INFO(compositions[k].name << "\n" << cubins[k].log);
    CHECK(cubins[k].compiled);
    CHECK(cubins[k].log.empty());  // no warnings either
    for (const std::string& entry : compositions[k].entries)
      if (cubins[k].code.find(entry) == std::string::npos) FAIL_CHECK("no entry " << entry);
  }
}

const std::vector<std::string> precisions{"double", "float"},
    axisymmetric{set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};

}  // namespace

TEST_CASE("every plugin compiles to machine code with NVRTC where it is installed", "[device]") {
  std::string why;
  const auto nvrtc = device::Nvrtc::find(why);
  if (!nvrtc) {
    WARN("skipped: " << why);
    REQUIRE(why.find("install") != why.npos);
    return;
  }
  // Each in the plane, around an axis and in 3-D, and in both precisions; the slow part has all of these together.
  std::vector<device::Composition> compositions;
  for (const int dimension : {2, 3}) {
    const std::vector<Mix> mixes = every_plugin_once(dimension);
    for (std::size_t k = 0; k < mixes.size(); ++k) {
      compositions.push_back(composition_of(mixes[k], precisions[k % 2]));
      if (dimension == 2) compositions.push_back(composition_of(mixes[k], precisions[(k + 1) % 2], axisymmetric));
    }
    for (const auto& [transfer, precision] : {std::pair{"flip", "double"}, std::pair{"asflip", "float"}}) {
      const Mix mix = warm_mix(dimension, std::string("{\"type\": \"") + transfer + "\"}");
      compositions.push_back(composition_of(mix, precision));
      const std::vector<std::string>& entries = compositions.back().entries;
      REQUIRE(std::count(entries.begin(), entries.end(), "mpm_change_phase_0") == 1);
    }
  }
  for (const std::string& precision : precisions)
    compositions.push_back(composition_of(mix_with_every_operation(3), precision));
  REQUIRE(compositions.size() >= 3 * plugins().of_kind(MPM_SHAPE).size());
  check_that_they_compile(*nvrtc, compositions);
}

TEST_CASE("every plugin compiles with NVRTC in each precision and symmetry", "[device][slow]") {
  std::string why;
  const auto nvrtc = device::Nvrtc::find(why);
  if (!nvrtc) {
    WARN("skipped: " << why);
    return;
  }
  std::vector<device::Composition> compositions;
  for (const std::string& precision : precisions)
    for (const int dimension : {2, 3}) {
      for (const Mix& mix : every_plugin_once(dimension)) {
        compositions.push_back(composition_of(mix, precision));
        if (dimension == 2) compositions.push_back(composition_of(mix, precision, axisymmetric));
      }
      for (const std::string transfer : {R"({"type": "flip"})", R"({"type": "asflip"})"})
        compositions.push_back(composition_of(warm_mix(dimension, transfer), precision));
    }
  check_that_they_compile(*nvrtc, compositions);
}

TEST_CASE("NVRTC says what is wrong with a composition", "[device]") {
  std::string why;
  const auto nvrtc = device::Nvrtc::find(why);
  if (!nvrtc) {
    WARN("skipped: " << why);
    return;
  }
  device::Composition broken{"a broken one", "#line 7 \"shape plugin odd\"\nint f() { return nowhere; }\n", "", {}};
  const device::Cubin cubin = nvrtc->compile(broken, "sm_90");
  CHECK_FALSE(cubin.compiled);
  CHECK(cubin.log.find("a broken one") != std::string::npos);
  CHECK(cubin.log.find("shape plugin odd(7)") != std::string::npos);
  CHECK(cubin.log.find("nowhere") != std::string::npos);
}
