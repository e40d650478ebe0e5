// The composed text goes through NVIDIA's run-time compiler, to machine code; no GPU is needed.

#include "backends/device/drivers/nvrtc.hpp"

#include <atomic>
#include <thread>

#include "device/covering.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("every plugin compiles to machine code with NVRTC where it is installed", "[device]") {
  std::string why;
  const auto nvrtc = device::Nvrtc::find(why);
  if (!nvrtc) {
    WARN("skipped: " << why);
    REQUIRE(why.find("install") != why.npos);
    return;
  }
  std::vector<device::Composition> compositions;
  for (const int dimension : {2, 3})
    for (const Mix& mix : every_plugin_once(dimension))
      for (const std::string precision : {"double", "float"}) {
        const std::string text = mix.text();
        compositions.push_back(device::compose(device_choice_of(device_experiment(text, precision))));
        if (dimension == 2)
          compositions.push_back(device::compose(device_choice_of(device_experiment(
              text, precision, {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")}))));
      }
  for (const int dimension : {2, 3})
    for (const std::string transfer : {R"({"type": "flip"})", R"({"type": "asflip"})"})
      for (const std::string precision : {"double", "float"}) {
        const Mix mix = warm_mix(dimension, transfer);
        const device::Composition composition =
            device::compose(device_choice_of(device_experiment(mix.text(), precision, mix.overrides)));
        REQUIRE(std::count(composition.entries.begin(), composition.entries.end(), "mpm_change_phase_0") == 1);
        compositions.push_back(composition);
      }
  REQUIRE(compositions.size() >= 4 * plugins().of_kind(MPM_SHAPE).size());
  std::vector<device::Cubin> cubins(compositions.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t k = next++; k < compositions.size(); k = next++)
      cubins[k] = nvrtc->compile(compositions[k], k % 8 == 0 ? "sm_80" : "sm_90");
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
