// The same text through NVIDIA's run-time compiler, to machine code; no GPU is needed.

#include "backends/device/drivers/nvrtc.hpp"

#include <atomic>
#include <thread>

#include "device/device_support.hpp"
#include "plugin/extension_of.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Compositions that hold every plugin at least once: the k-th of each kind together, with all materials.
std::vector<device::Choice> every_plugin_once(int dimension, Precision precision) {
  const auto shapes = plugins().of_kind(MPM_SHAPE), transfers = plugins().of_kind(MPM_TRANSFER),
             filters = plugins().of_kind(MPM_FILTER), contacts = plugins().of_kind(MPM_CONTACT),
             materials = plugins().of_kind(MPM_MATERIAL);
  const std::size_t most = std::max({shapes.size(), transfers.size(), filters.size(), contacts.size()});
  std::vector<device::Choice> choices;
  for (std::size_t k = 0; k < most; ++k) {
    device::Choice choice;
    choice.dimension = dimension, choice.precision = precision;
    choice.shape = shapes[k % shapes.size()], choice.transfer = transfers[k % transfers.size()];
    if (extension_of<mpm_transfer_polynomials>(*choice.transfer) && choice.shape->shape().form == MPM_TENSOR_PRODUCT)
      choice.basis_order = static_cast<int>(choice.shape->shape().width) - 1;
    if (k < filters.size()) choice.filter = filters[k];
    if (k < contacts.size()) choice.contact = contacts[k];
    for (std::size_t m = k; m < materials.size(); m += most) choice.materials.push_back(materials[m]);
    if (choice.materials.empty()) choice.materials.push_back(materials[k % materials.size()]);
    choices.push_back(choice);
  }
  return choices;
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
    for (const Precision precision : {Precision::double_, Precision::single})
      for (device::Choice& choice : every_plugin_once(dimension, precision)) {
        compositions.push_back(device::compose(choice));
        choice.axisymmetric = true;
        if (dimension == 2) compositions.push_back(device::compose(choice));
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
