// The composed text goes through NVIDIA's run-time compiler, to machine code; no GPU is needed.

#include "backends/device/drivers/nvrtc.hpp"

#include <atomic>
#include <thread>

#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Mixes that hold every plugin at least once: the k-th of each kind together, or apart where these are refused.
std::vector<Mix> every_plugin_once(int dimension) {
  const auto shapes = plugins().of_kind(MPM_SHAPE), transfers = plugins().of_kind(MPM_TRANSFER),
             filters = plugins().of_kind(MPM_FILTER), contacts = plugins().of_kind(MPM_CONTACT),
             materials = plugins().of_kind(MPM_MATERIAL);
  const std::size_t most =
      std::max({shapes.size(), transfers.size(), filters.size(), contacts.size(), materials.size()});
  std::vector<Mix> mixes;
  for (std::size_t k = 0; k < most; ++k) {
    const Plugin *const shape = shapes[k % shapes.size()], *const transfer = transfers[k % transfers.size()],
                        *const material = materials[k % materials.size()];
    Mix mix = mix_with(*shape, dimension);
    mix.transfer = device_choice(*transfer), mix.material = device_choice(*material);
    if (k < filters.size()) mix.filter = device_choice(*filters[k]);
    if (k < contacts.size()) mix.contact = device_choice(*contacts[k]);
    if (!is_refused(mix)) {
      mixes.push_back(mix);
      continue;
    }
    for (const Plugin* plugin : {shape, transfer, material}) mixes.push_back(mix_with(*plugin, dimension));
    if (k < filters.size()) mixes.push_back(mix_with(*filters[k], dimension));
    if (k < contacts.size()) mixes.push_back(mix_with(*contacts[k], dimension));
  }
  return mixes;
}

/// Everything that has to do with temperature at once, where shared memory is fullest: in three dimensions with contact.
Mix warm_mix(int dimension, const std::string& transfer) {
  Mix mix;
  mix.dimension = dimension, mix.transfer = transfer, mix.contact = R"({"type": "coulomb", "friction": 0.2})";
  mix.material = R"({"type": "von_mises", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
    "yield_stress": 60, "thermal": {"conductivity": 500, "heat_capacity": 10, "dissipation_to_heat": 0.9,
    "phase_change": {"temperature": 22, "latent_heat": 10, "melted": {"youngs_modulus": 600}}}})";
  mix.boundaries = R"({"all": "slip", "x_min": {"type": "slip", "temperature": 30},
    "x_max": {"type": "slip", "heat_flux": 9000},
    "y_min": {"type": "slip", "convection": {"coefficient": 900, "temperature": 60}}})";
  mix.more = std::string(R"(, "body_force": [1, 2)") + (dimension == 3 ? ", 3]" : "]");
  mix.overrides = {set("/bodies/0/temperature", "20"), set("/bodies/1/temperature", "25")};
  return mix;
}

}  // namespace

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
