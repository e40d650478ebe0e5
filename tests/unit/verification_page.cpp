// docs/verification.md names the files that hold its cases: none is missing there, none is named that does not exist.
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;

namespace {

const fs::path source = MPM_SOURCE_DIR;

/// The paths in the rows of the page; a name without a folder lies in the folder of the name before.
std::set<std::string> named_files() {
  const std::string page = mpm::support::read_file(source / "docs/verification.md");
  const std::regex quoted("`((?:tests|modules)/(?:[a-z_]+/)+)?([a-z0-9_]+\\.cpp)`");
  std::set<std::string> names;
  std::string folder;
  for (std::sregex_iterator match(page.begin(), page.end(), quoted), end; match != end; ++match) {
    if ((*match)[1].matched) folder = (*match)[1];
    names.insert(folder + (*match)[2].str());
  }
  return names;
}

}  // namespace

TEST_CASE("every file that the catalogue of cases names exists", "[docs]") {
  const auto names = named_files();
  CHECK(names.size() > 40);
  for (const std::string& name : names) {
    CAPTURE(name);
    CHECK(fs::is_regular_file(source / name));
  }
}

TEST_CASE("every file of verification is in the catalogue of cases", "[docs]") {
  const auto names = named_files();
  for (const auto& entry : fs::directory_iterator(source / "tests/verification")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string name = "tests/verification/" + entry.path().filename().string();
    CAPTURE(name);
    CHECK(names.count(name) == 1);
  }
}

TEST_CASE("the page of what is verified has a line for every case that it runs", "[docs]") {
  const std::string page = mpm::support::read_file(source / "docs/verified.md");
  const std::regex begins(R"re(TEST_CASE\(\s*"([^"]*)",\s*"([^"]*)"\))re");
  int cases = 0;
  for (const std::string suite : {"conformance", "verification", "faults", "stability"})
    for (const auto& entry : fs::directory_iterator(source / "tests" / suite)) {
      if (entry.path().extension() != ".cpp") continue;
      const std::string text = mpm::support::read_file(entry.path());
      for (std::sregex_iterator match(text.begin(), text.end(), begins), end; match != end; ++match) {
        if ((*match)[2].str().find("[slow]") != std::string::npos) continue;
        const std::string name = std::regex_replace((*match)[1].str(), std::regex(R"(\|)"), R"(\|)");
        INFO(suite << ": " << name << " (docs/generate_verified.sh writes the page anew)");
        CHECK(page.find("| " + name + " |") != std::string::npos);
        ++cases;
      }
    }
  CHECK(cases > 150);
}
