// `mpm test-plugin` runs the text that a plugin carries in the device's kernels, and finds one that does another thing
// than the plugin's file.

#include "mpm/test_plugin_device.hpp"

#include <cstdlib>

#include "device/changed_plugin.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

std::string all_of(const std::vector<ConformanceFinding>& findings) {
  std::string text;
  for (const ConformanceFinding& finding : findings) text += to_string(finding) + "\n";
  return text;
}

bool all_passed(const std::vector<ConformanceFinding>& findings) {
  return std::all_of(findings.begin(), findings.end(), [](const auto& finding) { return finding.passed; });
}

struct CacheIn {
  explicit CacheIn(const std::filesystem::path& folder) { setenv("MPM_CACHE", folder.c_str(), 1); }
  ~CacheIn() { unsetenv("MPM_CACHE"); }
};

}  // namespace

TEST_CASE("the text of a plugin of each kind does on the host driver what its file does", "[device][plugin]") {
  device_setup();
  const TemporaryFolder folder;
  const CacheIn here(folder / "cache");
  std::vector<std::string> named;
  for (const auto& [kind, id] : {std::pair{MPM_SHAPE, "gimp_contiguous"},
                                 {MPM_TRANSFER, "flip"},
                                 {MPM_FILTER, "xpic"},
                                 {MPM_CONTACT, "coulomb"},
                                 {MPM_MATERIAL, "von_mises"}}) {
    const std::vector<ConformanceFinding> findings = app::check_plugin_on_device(
        *plugins().find(kind, id), [&](std::string_view name) { named.emplace_back(name); });
    INFO(id << "\n" << all_of(findings));
    REQUIRE(findings.size() >= 3);
    CHECK(findings[0].check == "device [host, double, 2-D]");
    CHECK(findings[1].check == "device [host, float, 2-D]");
    CHECK(findings[2].check == "device [host, double, 3-D]");
    CHECK(all_passed(findings));
    for (const ConformanceFinding& finding : findings) {
      CHECK(finding.measured > 0);  // two programs of one method never round alike
      CHECK(finding.detail.find("not run") == std::string::npos);
    }
  }
  CHECK(named.size() >= 15);
}

TEST_CASE("a text that does another thing than the plugin's file fails", "[device][plugin]") {
  device_setup();
  const TemporaryFolder folder;
  const CacheIn here(folder / "cache");
  ChangedPlugin odd(MPM_MATERIAL, "neo_hookean");
  odd.replace("const S J = ", "const S J = real<S>(1.0001) * ");
  const std::vector<ConformanceFinding> findings = app::check_plugin_on_device(odd.plugin(), {});
  INFO(all_of(findings));
  REQUIRE(findings.size() >= 3);
  CHECK(!findings[0].passed);
  CHECK(findings[0].measured > findings[0].bound);
}

TEST_CASE("a text that does not compile, and none at all, are said", "[device][plugin]") {
  device_setup();
  const TemporaryFolder folder;
  const CacheIn here(folder / "cache");
  ChangedPlugin broken(MPM_SHAPE, "bspline_quadratic");
  broken.replace("#include", "int wrong() { return nowhere; }\n#include");
  const std::vector<ConformanceFinding> findings = app::check_plugin_on_device(broken.plugin(), {});
  INFO(all_of(findings));
  REQUIRE(!findings.empty());
  CHECK(!findings[0].passed);
  CHECK(findings[0].detail.find("shape plugin bspline_quadratic:") != std::string::npos);
  CHECK(findings[0].detail.find("nowhere") != std::string::npos);

  Plugin plugin = *plugins().find(MPM_SHAPE, "bspline_quadratic");
  mpm_descriptor descriptor = *plugin.descriptor;
  descriptor.source = "";
  plugin.descriptor = &descriptor;
  const std::vector<ConformanceFinding> none = app::check_plugin_on_device(plugin, {});
  REQUIRE(none.size() == 1);
  CHECK(none[0].passed);
  CHECK(none[0].detail.find("carries no text of its functor") != std::string::npos);
}
