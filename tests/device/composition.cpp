// The composed text itself: what is in it, how it is named, and what is refused.

#include "backends/device/device.hpp"
#include "backends/device/drivers/nvrtc.hpp"
#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

device::Choice usual_choice() {
  return device_choice_of(device_experiment(Mix{}.text(), "double"));
}

/// A copy of the usual shape whose functor's text is another.
struct OddShape {
  mpm_descriptor descriptor = *plugins().find(MPM_SHAPE, "bspline_quadratic")->descriptor;
  Plugin plugin;
  explicit OddShape(const char* source) {
    descriptor.source = source;
    plugin.descriptor = &descriptor;
  }
};

}  // namespace

TEST_CASE("a composition is one text without directives to include", "[device]") {
  const device::Composition composition = device::compose(usual_choice());
  CHECK(composition.name == "2-D double: bspline_quadratic apic neo_hookean");
  CHECK(composition.text.find("#include") == std::string::npos);
  CHECK(composition.text.find("#pragma once") == std::string::npos);
  CHECK(composition.text.find("struct BsplineQuadratic") != std::string::npos);
  CHECK(composition.text.find("plugin/abi.h") == std::string::npos);
  for (const std::string entry : {"mpm_clear", "mpm_scatter", "mpm_gather", "mpm_move", "mpm_stress_0", "mpm_strain_0"})
    CHECK(std::count(composition.entries.begin(), composition.entries.end(), entry) == 1);
  for (const std::string entry : {"mpm_contact", "mpm_project", "mpm_stress_1"})
    CHECK(std::count(composition.entries.begin(), composition.entries.end(), entry) == 0);
}

TEST_CASE("a plugin that two materials share is in the text once", "[device]") {
  device::Choice choice = usual_choice();
  choice.materials.push_back(choice.materials[0]);
  const std::string text = device::compose(choice).text;
  const std::size_t first = text.find("struct NeoHookean : ");
  REQUIRE(first != text.npos);
  CHECK(text.find("struct NeoHookean : ", first + 1) == text.npos);
}

TEST_CASE("the hash names text and options", "[device]") {
  const device::Choice choice = usual_choice();
  const device::Composition first = device::compose(choice), again = device::compose(choice);
  CHECK(first.hash == again.hash);
  CHECK(first.hash.size() == 64);
  std::set<std::string> hashes{first.hash};
  device::Choice other = choice;
  other.dimension = 3;
  CHECK(hashes.insert(device::compose(other).hash).second);
  other = choice, other.precision = Precision::single;
  CHECK(hashes.insert(device::compose(other).hash).second);
  other = choice, other.transfer = plugins().find(MPM_TRANSFER, "mls");
  CHECK(hashes.insert(device::compose(other).hash).second);
  other = choice, other.contact = plugins().find(MPM_CONTACT, "stick");
  CHECK(hashes.insert(device::compose(other).hash).second);

  const std::string key = device::cache_key(first, "NVRTC 13.0", device::Nvrtc::options("sm_90"));
  CHECK(key == device::cache_key(again, "NVRTC 13.0", device::Nvrtc::options("sm_90")));
  CHECK(key != device::cache_key(first, "NVRTC 13.0", device::Nvrtc::options("sm_80")));
  CHECK(key != device::cache_key(first, "NVRTC 12.9", device::Nvrtc::options("sm_90")));
}

TEST_CASE("a functor that includes what a device cannot see is refused with its place", "[device]") {
  device::Choice choice = usual_choice();
  SECTION("a system header") {
    const OddShape odd("#pragma once\n#include \"kernel/functor.hpp\"\n#include <vector>\n");
    choice.shape = &odd.plugin;
    CHECK_THROWS_WITH(device::compose(choice),
                      ContainsSubstring("shape plugin bspline_quadratic, line 3 includes <vector>"));
  }
  SECTION("a header that is not there") {
    const OddShape odd("#include \"kernel/nothing.hpp\"\n");
    choice.shape = &odd.plugin;
    CHECK_THROWS_WITH(device::compose(choice), ContainsSubstring("\"kernel/nothing.hpp\""));
  }
  SECTION("no text at all") {
    const OddShape odd("");
    choice.shape = &odd.plugin;
    CHECK_THROWS_WITH(device::compose(choice), ContainsSubstring("mpm_add_plugin"));
  }
  SECTION("but what only the host sees may stay") {
    const std::string text = "#if MPM_HOST\n#include <vector>\n#endif\n" +
                             std::string(plugins().find(MPM_SHAPE, "bspline_quadratic")->descriptor->source);
    const OddShape odd(text.c_str());
    choice.shape = &odd.plugin;
    CHECK_NOTHROW(device::HostCompiler{}.compile(device::compose(choice)));
  }
}

TEST_CASE("the host-run device says what a compiler refuses and where", "[device]") {
  device::Composition broken{"a broken one", "#line 7 \"shape plugin odd\"\nint f() { return nowhere; }\n", "", {}};
  CHECK_THROWS_WITH(device::HostCompiler{}.compile(broken), ContainsSubstring("a broken one") &&
                                                                ContainsSubstring("shape plugin odd:7") &&
                                                                ContainsSubstring("nowhere"));
  device::HostCompiler none;
  none.program = "no-such-compiler";
  CHECK_THROWS_WITH(none.compile(broken), ContainsSubstring("apt install g++"));
}

TEST_CASE("the host-run device names a phase that a composition lacks", "[device]") {
  const device::Composition composition = device::compose(usual_choice());
  const device::DeviceSetup setup = device_setup();
  device::Device device(*setup.driver, setup.number);
  device.load(Programs::shared().of(composition), composition.name);
  CHECK_THROWS_WITH(device.launch("contact", device::Arguments<double>{}, 1, 1),
                    ContainsSubstring("no phase \"contact\""));
}
