// Runs the conformance suite on every plugin that was built. MPM_CONFORMANCE_PRINT=1 prints all findings.

#include <cstdlib>
#include <iostream>

#include "conformance/conformance.hpp"
#include "support/catch.hpp"

namespace {

const mpm::Registry& registry() {
  static const mpm::Registry found = mpm::Registry::from_folders(mpm::Registry::default_folders());
  return found;
}

}  // namespace

TEST_CASE("plugins were found and none was rejected") {
  for (const std::string& message : registry().rejected()) INFO(message);
  CHECK(registry().rejected().empty());
  for (const mpm_kind kind : mpm::all_kinds()) {
    INFO("kind " << mpm::kind_name(kind));
    CHECK_FALSE(registry().of_kind(kind).empty());
  }
}

TEST_CASE("every built plugin conforms") {
  const bool print = std::getenv("MPM_CONFORMANCE_PRINT") != nullptr;
  for (const mpm::Plugin& plugin : registry().plugins()) {
    const std::string name =
        std::string(mpm::kind_name(static_cast<mpm_kind>(plugin.descriptor->kind))) + " " + std::string(plugin.id());
    DYNAMIC_SECTION(name) {
      for (const mpm::ConformanceFinding& finding : mpm::check_plugin(plugin)) {
        if (print) std::cout << name << ": " << mpm::to_string(finding) << '\n';
        INFO(mpm::to_string(finding));
        CHECK(finding.passed);
      }
    }
  }
}
