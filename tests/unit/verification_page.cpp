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
#include "support/literals.hpp"
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

/// A row of a table of the page: its first cell, its text, and the files of tests that it names, or its table where it names none.
struct Row {
  std::string name, text;
  std::vector<std::string> files;
};

std::vector<Row> rows_of_the_page() {
  // Tables of numbers alone, by the heading before them.
  const std::map<std::string, std::vector<std::string>> of_tables{
      {"### Damping of a wave in one step", {"tests/verification/transfer_damping.cpp"}},
      {"### Largest stable Courant number", {"tests/verification/critical_step.cpp"}},
      {"### Neo-Hookean numbers",
       {"tests/conformance/neo_hookean_paths.cpp", "tests/verification/material_point.cpp"}}};
  // Where a row's test takes its scene or its exact solution from.
  const std::map<std::string, std::string> more{{"Taylor bar", "experiments/gallery/taylor_bar.json"},
                                                {"Stefan, one phase", "tests/unit/heat_solutions.cpp"},
                                                {"Freezing water, two phases", "tests/unit/heat_solutions.cpp"},
                                                {"Sliding block", "tests/verification/rolling_wheel.cpp"}};
  const std::regex quoted("`((?:tests|modules)/(?:[a-z_]+/)+)?([a-z0-9_]+\\.cpp)`");
  std::istringstream page(mpm::support::read_file(source / "docs/verification.md"));
  std::vector<Row> rows;
  std::string folder, heading;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with('#')) heading = line;
    Row row{"", line, {}};
    for (std::sregex_iterator match(line.begin(), line.end(), quoted), end; match != end; ++match) {
      if ((*match)[1].matched) folder = (*match)[1];
      row.files.push_back(folder + (*match)[2].str());
    }
    if (!line.starts_with("| ")) continue;
    row.name = line.substr(2, line.find(" |", 2) - 2);
    if (const auto table = of_tables.find(heading); table != of_tables.end() && row.files.empty())
      row.files = table->second;
    if (const auto file = more.find(row.name); file != more.end()) row.files.push_back(file->second);
    for (std::size_t k = 0, named = row.files.size(); k < named;
         ++k)  // what a test shares with another stands in a header
      if (const std::string header = fs::path(row.files[k]).replace_extension(".hpp"); fs::exists(source / header))
        row.files.push_back(header);
    rows.push_back(row);
  }
  return rows;
}

/// What follows from the numbers of a row's test by a line of arithmetic.
std::vector<double> follows(const std::string& name) {
  const std::map<std::string, std::vector<double>> known{
      {"Dropped calls", {16 * 4}},                               // calls, numbers
      {"centre; linear, quadratic, uGIMP", {1 / std::sqrt(8)}},  // half of 1/sqrt(2), by FMPM(4)
      {"Mohr-Coulomb paths", {100. / 3}},                        // (1 - sin 30) / (1 + sin 30) of 100 kPa
      {"Shock of a piston", {7. / 5}},                           // of two atoms a molecule
      {"Rigid bodies", {std::sqrt(1 * 0.05) / 0.05}}};           // sqrt(R d), in cells
  const auto found = known.find(name);
  return found == known.end() ? std::vector<double>{} : found->second;
}

}  // namespace

// Of one significant digit are numbers that stand everywhere.
TEST_CASE("numbers of two significant digits in the tables of the catalogue stand in the tests that their row names",
          "[docs]") {
  // Names, years with the journal's page, and indices of a tensor.
  const std::vector<std::string> names{"[23]-D", "(FMPM|XPIC)\\([0-9]+\\)", "[a-z.] (19|20)[0-9]{2}\\b(, 11\\.2)?",
                                       "2604\\.07307", "[σεγτ][0-9]+"};
  int compared = 0;
  for (const Row& row : rows_of_the_page())
    for (const mpm::test::PrintedNumber& printed : mpm::test::numbers_in(row.text, names)) {
      std::string digits = std::to_string(printed.value);
      digits = std::regex_replace(digits, std::regex("^[0.]*|[0.]*$|\\."), "");
      if (digits.size() < 2 || printed.half_unit == 0) continue;
      INFO(printed.value << " of the row " << row.name);
      bool found = mpm::test::stands_in(printed, row.files);
      for (const double number : follows(row.name)) found = found || mpm::test::is_printed_as(number, printed);
      CHECK(found);
      ++compared;
    }
  CHECK(compared > 250);
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

TEST_CASE("a program of tests fails where a number is more than four times as large as its row of verified cases says",
          "[docs]") {
  for (const char* cells :
       {"3 | 0.01 | 0.5", "9 | 0.01 | 0.5", "3 | 0.0026 | 0.5", "3 | 0.5 | 0.5", "3 | 0.01 | 0.13", "3 |  | 0.5"}) {
    INFO(cells);
    CHECK(compared_with(cells) == 0);
  }
  for (const char* cells : {"3 | 0.0024 | 0.5", "3 | 0.01 | 0.12"}) {
    INFO(cells);
    CHECK(compared_with(cells) != 0);
  }
}
