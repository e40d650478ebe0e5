// docs/design/how_to_add.md names files to copy and to change: each of them exists.
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"

namespace fs = std::filesystem;

namespace {

const fs::path source = MPM_SOURCE_DIR;

/// The files and folders that a page names in `code`. A name without a folder lies in the folder of the name before. Names with
/// a placeholder (ID, FILE, KIND) and commands stand for no file.
std::vector<fs::path> named_paths(const std::string& page) {
  const std::regex quoted("`([A-Za-z0-9_./]+)`"), file(".*\\.(?:[chi]pp|cmake|md|sh|txt|in)"),
      placeholder(".*\\b(?:ID|FILE|KIND)\\b.*");
  std::vector<fs::path> paths;
  fs::path folder;
  for (std::sregex_iterator match(page.begin(), page.end(), quoted), end; match != end; ++match) {
    const std::string name = (*match)[1];
    const bool in_folder = name.find('/') != std::string::npos;
    if (std::regex_match(name, placeholder) || !(in_folder || std::regex_match(name, file))) continue;
    if (in_folder) folder = name.back() == '/' ? fs::path(name) : fs::path(name).parent_path();
    paths.push_back(in_folder ? fs::path(name) : folder / name);
  }
  return paths;
}

}  // namespace

TEST_CASE("every file that the page of how to add something names exists", "[docs]") {
  const auto paths = named_paths(mpm::support::read_file(source / "docs/design/how_to_add.md"));
  CHECK(paths.size() > 60);
  for (const fs::path& path : paths) {
    CAPTURE(path.string());
    CHECK(fs::exists(source / path));
  }
}

TEST_CASE("a name without a folder lies in the folder of the name before", "[docs]") {
  const auto paths =
      named_paths("`modules/a/b.hpp`, `c.cpp` of `Act::d`, `ID.cpp`, `modules/e/ID/`, `modules/f/` and `g.hpp`");
  CHECK(paths == std::vector<fs::path>{"modules/a/b.hpp", "modules/a/c.cpp", "modules/f/", "modules/f/g.hpp"});
}
