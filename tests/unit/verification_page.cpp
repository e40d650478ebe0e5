// docs/verification.md names the files that hold its cases, and docs/verified.md the cases themselves: none is missing there,
// none is named that does not exist.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/temporary_folder.hpp"

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

namespace {

/// A positive number without its power of ten, from 1 to below 10.
double mantissa(double value) {
  return value / std::pow(10.0, std::floor(std::log10(value)));
}

/// The mantissas of all numbers in the texts of the tests, and of what they lack to 1.
std::set<double> numbers_of_the_tests() {
  static const std::regex number("[0-9]*\\.[0-9]+|[0-9]+");
  std::set<double> found;
  for (const auto& entry : fs::recursive_directory_iterator(source / "tests")) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
    const std::string text = mpm::support::read_file(entry.path());
    for (std::sregex_iterator match(text.begin(), text.end(), number), end; match != end; ++match) {
      const double value = std::stod(match->str());
      if (value > 0) found.insert(mantissa(value));
      if (value > 0 && value < 1) found.insert(mantissa(1 - value));
    }
  }
  return found;
}

}  // namespace

// Numbers of five digits and more: shorter ones stand everywhere.
TEST_CASE("the numbers in the tables of the catalogue of cases are numbers of the tests", "[docs]") {
  const std::set<double> of_tests = numbers_of_the_tests();
  std::istringstream page(mpm::support::read_file(source / "docs/verification.md"));
  const std::regex number("[0-9]+\\.[0-9]+"), zeros("^0*\\.?0*|0+$|\\.");
  int compared = 0;
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with('|')) continue;
    for (std::sregex_iterator match(line.begin(), line.end(), number), end; match != end; ++match) {
      const std::string digits = std::regex_replace(match->str(), zeros, "");
      if (digits.size() < 5 || match->str() == "2604.07307") continue;  // the latter of arXiv
      const double printed = mantissa(std::stod(match->str()));
      const double half = 0.5000001 * std::pow(10.0, 1 - static_cast<double>(digits.size()));
      INFO(match->str() << " in " << line.substr(0, 60));
      const auto nearest = of_tests.lower_bound(printed - half);
      CHECK((nearest != of_tests.end() && *nearest <= printed + half));
      ++compared;
    }
  }
  CHECK(compared > 120);
}

namespace {

std::vector<fs::path> sources_of(const std::string& suite) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(source / "tests" / suite))
    if (entry.path().extension() == ".cpp") files.push_back(entry.path());
  return files;
}

/// The first cells of the rows of docs/verified.md, by file, as the tests name their cases.
std::map<std::string, std::set<std::string>> verified_cases() {
  std::istringstream page(mpm::support::read_file(source / "docs/verified.md"));
  std::map<std::string, std::set<std::string>> cases;
  std::string file;
  const std::regex heading("## `([^`]+)`.*"), row(R"(\| (.*) \| [0-9]+ \| [^|]* \| [^|]* \|)");
  std::smatch match;
  for (std::string line; std::getline(page, line);)
    if (std::regex_match(line, match, heading))
      file = match[1];
    else if (std::regex_match(line, match, row))
      cases[file].insert(std::regex_replace(match[1].str(), std::regex(R"(\\\|)"), "|"));
  return cases;
}

/// Names of the cases in a test's text; one with a list of types is a case for each of them. Slow ones end in " (slow".
std::set<std::string> cases_of(const std::string& text) {
  static const std::regex begins(R"re((TEMPLATE_)?TEST_CASE\(\s*"((?:[^"\\]|\\.)*)"(?:,\s*"([^"]*)"([^)]*))?\))re");
  std::set<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), begins), end; match != end; ++match) {
    std::string name = std::regex_replace((*match)[2].str(), std::regex(R"(\\(.))"), "$1");
    if ((*match)[1].matched) {
      const std::string types = (*match)[4];
      const std::regex type("[A-Za-z:]+");
      for (std::sregex_iterator of(types.begin(), types.end(), type); of != end; ++of)
        names.insert(name + " - " + of->str());
      continue;
    }
    if ((*match)[3].str().find("[slow]") != std::string::npos) name += " (slow";
    names.insert(name);
  }
  return names;
}

}  // namespace

TEST_CASE("the page of what is verified has the cases of the tests and no others", "[docs]") {
  const auto on_page = verified_cases();
  INFO("docs/generate_verified.sh writes the page anew");
  std::size_t count = 0;
  std::set<std::string> files;
  for (const std::string suite : {"cli", "config", "conformance", "device", "faults", "parity", "regression",
                                  "stability", "unit", "verification"})
    for (const fs::path& path : sources_of(suite)) {
      const std::string file = "tests/" + suite + "/" + path.filename().string();
      std::set<std::string> written, listed;
      for (const std::string& name : cases_of(mpm::support::read_file(path)))
        if (name.find("the page of what is verified") == std::string::npos) written.insert(name);
      if (on_page.count(file))
        for (const std::string& name : on_page.at(file))
          listed.insert(std::regex_replace(name, std::regex(R"( \(slow, .*\)$)"), " (slow"));
      INFO(file);
      CHECK(written == listed);
      count += written.size(), files.insert(file);
    }
  CHECK(count > 900);
  for (const auto& [file, cases] : on_page) {
    INFO(file);
    CHECK(files.count(file) == 1);
  }
}

namespace {

/// What the program of these tests says of the one case below, with a page on which the row of the case has these cells.
int compared_with(const std::string& cells) {
  const mpm::test::TemporaryFolder folder;
  const std::string page = (folder / "page.md").string();
  std::ofstream(page) << "## `tests/unit/verification_page.cpp`\n\n| a row that is compared | " << cells << " |\n";
  return std::system(("env -u MPM_DISTANCES MPM_VERIFIED=" + page +
                      " '" MPM_BUILD_DIR "/bin/test_unit' 'a row that is compared' >/dev/null 2>&1")
                         .c_str());
}

}  // namespace

// Three assertions, 1 % apart, half of a bound used; and a value near zero, which counts as an assertion alone.
TEST_CASE("a row that is compared", "[docs]") {
  const double above_one = 1.01, half = 0.5, small = 1e-9;
  CHECK(above_one == Approx(1).epsilon(0.1));
  CHECK(half < 1);
  CHECK(small == Approx(1e-12).margin(1e-6));
}

TEST_CASE("a program of tests fails where a number in a row of verified cases is off by more than a factor of four",
          "[docs]") {
  for (const char* cells :
       {"3 | 0.01 | 0.5", "9 | 0.01 | 0.5", "3 | 0.0026 | 0.5", "3 | 0.039 | 0.5", "3 | 0.01 | 1.9"}) {
    INFO(cells);
    CHECK(compared_with(cells) == 0);
  }
  for (const char* cells :
       {"3 | 0.0024 | 0.5", "3 | 0.041 | 0.5", "3 |  | 0.5", "3 | 0.01 | 0.12", "3 | 0.01 | 2.1", "3 | 0.01 | "}) {
    INFO(cells);
    CHECK(compared_with(cells) != 0);
  }
}
