// The boundary is C: its header compiles alone as C and as C++, pedantically, and its layout is what the loader
// assumes.

#include <cstddef>
#include <type_traits>

#include "conformance/conformance.hpp"
#include "fixtures/mpm_fixture.hpp"
#include "plugin/abi.h"
#include "plugin/registry.hpp"
#include "support/catch.hpp"

TEST_CASE("abi.h compiles alone as C99, C11 and C++17") {
  const fixture::TemporaryFolder folder;
  const std::string strict =
      " -pedantic-errors -Wall -Wextra -Werror -fsyntax-only '" + (folder / "alone.c").string() + "'";
  std::ofstream(folder / "alone.c")
      << "#include \"plugin/abi.h\"\nextern const mpm_plugin_library mpm_plugin_library_v;\n";
  for (const char* language : {"-x c -std=c99", "-x c -std=c11", "-x c++ -std=c++17"}) {
    const int status = fixture::compile(language + strict, folder / "log");
    INFO(language << "\n" << fixture::contents(folder / "log"));
    CHECK(status == 0);
  }
}

TEST_CASE("kernel headers include kernel headers alone, and those of a compiler") {
  for (const auto& entry : fixture::fs::directory_iterator(fixture::fs::path(MPM_SOURCE_DIR) / "modules" / "kernel")) {
    std::ifstream lines(entry.path());
    for (std::string line; std::getline(lines, line);) {
      INFO(entry.path().filename() << ": " << line);
      CHECK((line.rfind("#include \"", 0) != 0 || line.rfind("#include \"kernel/", 0) == 0));
    }
  }
}

TEST_CASE("the version is the first word of the library table, and tables are plain data") {
  CHECK(offsetof(mpm_plugin_library, abi_version) == 0);
  CHECK(offsetof(mpm_plugin_library, struct_size) == 4);
  CHECK(std::is_standard_layout_v<mpm_plugin_library>);
  CHECK(std::is_trivially_copyable_v<mpm_descriptor>);
  CHECK(std::is_trivially_copyable_v<mpm_material_batch>);
  CHECK(MPM_BATCH % MPM_LANES == 0);
}

TEST_CASE("components of state fields in 2-D and 3-D") {
  const int expected[][2] = {{1, 1}, {2, 3}, {4, 9}, {4, 6}, {5, 9}, {4, 9}};
  for (int shape = 0; shape < 6; ++shape)
    for (int dimension : {2, 3})
      CHECK(mpm::state_components(static_cast<mpm_state_shape>(shape), dimension) == expected[shape][dimension - 2]);
}

TEST_CASE("a plugin written in plain C passes the conformance suite") {
  const fixture::TemporaryFolder folder;
  fixture::build_plugin(folder / "whole.so");
  mpm::Registry registry;
  registry.load(folder / "whole.so");
  for (const mpm::ConformanceFinding& finding : mpm::check_plugin(registry.plugins().front())) {
    INFO(mpm::to_string(finding));
    CHECK(finding.passed);
  }
}
