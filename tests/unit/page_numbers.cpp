// Every number of the pages of studies and of the method is one of a study's figure, or given: tests/unit/fixtures/page_numbers
// holds for each page its sentences, a # for each number, and where each number comes from:
//   "only FIGURE: CELL | CELL"   the value of the one row of figures/studies/FIGURE.csv that has these cells
//   "least …", "most …", "sum …", "first …", "last …", "count …"   the same of all rows that have them
//   "front FIGURE: CELL | CELL"  how many of the rows that have the cells are on the figure's front
//   "notes+ …"                   the numbers behind this sign in the rows' notes, added up
//   "runs PATH"                  how many combinations the study experiments/PATH.json has
//   {"as": FORMULA, "x": …, "y": …, "z": …}   a formula of such values
//   {"of": "least", "each": [WORD, …], …}     the least of them with each word in the place of {}
// A cell "!C" is one that a row must not have, "A / B" either of two, "A*" what begins with A, "*A" what ends
// with it, "*A*" what holds it. FIGURE#2 takes the values of
// another column than that of the figure. "words" are the sentences that state a quantity in words, each with a formula of such
// values: "rounded" of it to a whole number "is" what the word says (3 for a third of one over it), or it "holds", which is 1.
// "tables" name the test that compares them, and "given" says of which numbers no run decides, and why. Where a group of
// these is "from" files, each of its numbers stands in one of them: the experiment or the default that sets it, the test
// that asserts it, or the formula that has it. Where it is "read by" a test, the test's text has the sentences and compares
// what stands at each #, and a "test" is the case that compares them in another way.

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

#include "experiment/expression.hpp"
#include "materials/cam_clay/cam_clay.hpp"
#include "materials/drucker_prager/drucker_prager.hpp"
#include "materials/mohr_coulomb/mohr_coulomb.hpp"
#include "study/study.hpp"
#include "support/catch.hpp"
#include "support/csv.hpp"
#include "support/literals.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

using Json = nlohmann::json;
using Cells = std::vector<std::vector<std::string>>;

const Cells& figure(const std::string& name) {
  static std::map<std::string, Cells> read;
  const auto [entry, is_new] = read.try_emplace(name);
  if (is_new) entry->second = support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/" + name + ".csv");
  return entry->second;
}

std::vector<std::string> split(const std::string& text, const std::string& by) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t at; (at = text.find(by, from)) != std::string::npos; from = at + by.size())
    parts.push_back(text.substr(from, at - from));
  parts.push_back(text.substr(from));
  return parts;
}

std::optional<double> number(const std::string& text) {
  std::size_t end = 0;
  try {
    if (const double value = std::stod(text, &end); end == text.size()) return value;
  } catch (const std::exception&) {  // this is no number
  }
  return {};
}

bool is_cell(const std::string& cell, const std::string& wanted) {
  for (const std::string& one : split(wanted, " / ")) {
    if (one.size() > 2 && one.starts_with('*') && one.ends_with('*')) {
      if (cell.find(one.substr(1, one.size() - 2)) != std::string::npos) return true;
      continue;
    }
    if (cell == one || (one.ends_with('*') && cell.starts_with(one.substr(0, one.size() - 1)))) return true;
    if (one.starts_with('*') && cell.ends_with(one.substr(1))) return true;
    const auto value = number(cell), same = number(one);
    if (value && same && std::abs(*value - *same) <= 1e-8 * std::abs(*same)) return true;
  }
  return false;
}

/// Rows of a figure that have the cells; what dominates a point is no cell of its row.
Cells rows_of(const std::string& name, const std::string& cells) {
  Cells rows;
  const bool is_pareto = figure(name).front().back() == "dominated by";
  const std::size_t columns = figure(name).front().size() - is_pareto;
  for (const auto& row : figure(name)) {
    if (&row == &figure(name).front()) continue;
    const auto has = [&](const std::string& wanted) {
      return std::any_of(row.begin(), row.begin() + static_cast<long>(std::min(columns, row.size())),
                         [&](const std::string& cell) { return is_cell(cell, wanted); });
    };
    bool all = true;
    if (!cells.empty())
      for (const std::string& wanted : split(cells, " | "))
        all = all && (wanted.starts_with('!') ? !has(wanted.substr(1)) : has(wanted));
    if (all) rows.push_back(row);
  }
  return rows;
}

std::size_t column_of_values(const std::vector<std::string>& header) {
  return header.at(2) == "kind" ? 4 : header.at(1) == "kind" ? 3 : 2;
}

double sum_of_notes(const Cells& rows, const std::string& sign) {
  double sum = 0;
  for (const auto& row : rows)
    if (row.size() > 3)
      for (const std::string& note : split(row[3], " "))
        if (note.starts_with(sign)) sum += number(note.substr(sign.size())).value_or(0);
  return sum;
}

double runs_of(const std::string& path) {
  double runs = 1;
  for (const auto& axis : study::read_study(MPM_SOURCE_DIR "/experiments/" + path + ".json").axes)
    runs *= static_cast<double>(axis.choices.size());
  return runs;
}

double picked(const std::string& text) {
  const std::size_t blank = text.find(' ');
  const std::string take = text.substr(0, blank), rest = text.substr(blank + 1);
  if (take == "runs") return runs_of(rest);
  const std::size_t colon = rest.find(": ");
  const auto source = split(rest.substr(0, colon), "#");
  const Cells rows = rows_of(source[0], colon == std::string::npos ? "" : rest.substr(colon + 2));
  if (take.starts_with("notes")) return sum_of_notes(rows, take.substr(5));
  if (take == "count") return static_cast<double>(rows.size());
  if (take == "front")
    return static_cast<double>(
        std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.back().empty(); }));
  const std::size_t column = source.size() > 1 ? std::stoul(source[1]) : column_of_values(figure(source[0]).front());
  std::vector<double> values;
  for (const auto& row : rows)
    if (row.size() > column && !row[column].empty()) values.push_back(std::stod(row[column]));
  if (values.empty() || (take == "only" && values.size() != 1))
    throw std::runtime_error(std::to_string(values.size()) + " values: " + text);
  if (take == "only" || take == "first") return values.front();
  if (take == "last") return values.back();
  if (take == "sum") return std::accumulate(values.begin(), values.end(), 0.0);
  if (take == "mean") return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  if (take == "least") return *std::min_element(values.begin(), values.end());
  if (take == "most") return *std::max_element(values.begin(), values.end());
  throw std::runtime_error("no such take: " + text);
}

double value_of(const Json& source, const std::string& word = "") {
  const auto with_word = [&](std::string text) {
    for (std::size_t at; (at = text.find("{}")) != std::string::npos;) text.replace(at, 2, word);
    return text;
  };
  if (source.is_string()) return picked(with_word(source));
  if (word.empty() && source.contains("each")) {
    std::vector<double> values;
    for (const std::string each : source["each"]) values.push_back(value_of(source, each));
    return source["of"] == "least" ? *std::min_element(values.begin(), values.end())
                                   : *std::max_element(values.begin(), values.end());
  }
  Vector3 x{};
  for (int k = 0; k < 3; ++k)
    if (const std::string name(1, "xyz"[k]); source.contains(name)) x[k] = picked(with_word(source[name]));
  const VectorExpression::Term terms[] = {source.value("as", std::string("x"))};
  return VectorExpression(terms, {"xyz", {}})(x, x, 0)[0];
}

/// Whether a text of C++ has the words in one string, however it is broken over lines.
bool has_string(const std::string& file, const std::string& words) {
  const std::string text = support::read_file(MPM_SOURCE_DIR "/" + file);
  return std::regex_replace(text, std::regex("\"\\s+\""), "").find(words) != std::string::npos;
}

/// Whether tests have a case of this name, or the words begin with a file of tests that exists.
bool names_a_test(const std::string& words) {
  if (words.starts_with("tests/"))
    return std::filesystem::exists(MPM_SOURCE_DIR "/" + words.substr(0, words.find(' ')));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(MPM_SOURCE_DIR "/tests"))
    if (entry.path().extension() == ".cpp" &&
        support::read_file(entry.path()).find("TEST_CASE(\"" + words.substr(0, words.find(" ("))) != std::string::npos)
      return true;
  return false;
}

}  // namespace

TEST_CASE("every number of the listed pages, in digits and in words, is one of a figure, or given with where it stands",
          "[docs]") {
  int pages = 0, numbers = 0, words = 0, sources = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MPM_SOURCE_DIR "/tests/unit/fixtures/page_numbers")) {
    const Json list = Json::parse(support::read_file(entry.path()));
    const std::string file = list["page"];
    INFO(file << ", numbers listed in " << entry.path().filename());
    Page page(file);
    if (list.contains("section")) page.keep_from_to(list["section"][0], list["section"][1]);
    for (const Json& table : list.value("tables", Json::array())) {
      INFO(table["test"]);
      CHECK(names_a_test(table["test"]));
      page.leave_out_table_after(table["after"]);
    }
    page.add_names(list["names"]);
    for (const Json& sentence : list["measured"]) {
      const std::string says = sentence["says"];
      INFO(says);
      const auto printed = page.read(says);
      REQUIRE(printed.size() == sentence["is"].size());
      for (std::size_t k = 0; k < printed.size(); ++k) {
        INFO(sentence["is"][k]);
        CHECK(value_of(sentence["is"][k]) == printed[k].rounded());
      }
      page.add_measured(says);
      numbers += static_cast<int>(printed.size());
    }
    for (const Json& group : list["given"]) {
      page.add_given(group["says"]);
      if (group.contains("test")) {
        INFO(group["test"]);
        CHECK(names_a_test(group["test"]));
        ++sources;
      }
      if (group.contains("read by"))
        for (const std::string says : group["says"]) {
          INFO(says << " is not read by " << group["read by"]);
          CHECK(has_string(group["read by"], says));
          ++sources;
        }
      if (!group.contains("from")) continue;
      for (const std::string says : group["says"])
        for (const auto& printed : numbers_in(says, list["names"])) {
          INFO(says << ": " << printed.value << " stands nowhere in " << group["from"]);
          CHECK(stands_in(printed, group["from"]));
          ++sources;
        }
    }
    for (const Json& sentence : list.value("words", Json::array())) {
      const std::string says = sentence["says"];
      INFO(says);
      if (sentence.contains("holds"))
        CHECK(value_of(sentence["holds"]) == 1);
      else
        CHECK(std::round(value_of(sentence["rounded"])) == sentence["is"].get<double>());
      page.add_given({says});
      ++words;
    }
    for (const std::string& left : page.numbers_of_nobody()) FAIL_CHECK("a number that nothing gives: " << left);
    for (const std::string& left : page.words_of_nobody()) FAIL_CHECK("a quantity that nothing gives: " << left);
    ++pages;
  }
  CHECK(pages > 0);
  CHECK(numbers > 10 * pages);
  CHECK(words > pages);
  CHECK(sources > 0);
}

TEST_CASE("beside the command of a study stands how many runs it has", "[docs]") {
  const std::regex call("mpm study experiments/([a-z0-9_/]+)\\.json[^#\n]*# ([0-9]+) (?:runs|combinations)");
  int calls = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(MPM_SOURCE_DIR "/docs")) {
    if (entry.path().extension() != ".md") continue;
    const std::string page = support::read_file(entry.path());
    for (std::sregex_iterator match(page.begin(), page.end(), call), end; match != end; ++match) {
      INFO(entry.path().filename() << ": " << match->str());
      CHECK(runs_of((*match)[1]) == std::stod((*match)[2]));
      ++calls;
    }
  }
  CHECK(calls >= 12);
}

TEST_CASE("every quantity in words of lesson 7 is listed beside the numbers of the page", "[docs]") {
  const Json list = Json::parse(support::read_file(MPM_SOURCE_DIR "/tests/python/page_numbers/7_own_body.json"));
  Page page(list["page"]);
  page.add_names(list["names"]);
  for (const Json& sentence : list["measured"]) page.add_given({sentence["says"]});
  for (const Json& sentence : list["words"]) page.add_given({sentence["says"]});
  for (const Json& group : list["given"]) page.add_given(group["says"]);
  CHECK(page.words_of_nobody() == std::vector<std::string>{});
}

// docs/plugins.md is made of the plugins' manuals. Numbers of their prose stand in the plugin's own formulas, in the tests and
// experiments that have them, or follow from them; those of the literature are listed.

namespace {

struct Manual {
  std::string id, prose;
};

/// The manuals without their first line, formulas that stand apart, sources, and the lists of what the plugin declares.
std::vector<Manual> manuals() {
  std::istringstream page(mpm::support::read_file(MPM_SOURCE_DIR "/docs/plugins.md"));
  std::vector<Manual> found;
  bool in_prose = false, is_first = false;
  for (std::string line; std::getline(page, line);) {
    if (line == "```text") {
      found.emplace_back();
      in_prose = is_first = true;
    } else if (is_first) {
      found.back().id = line.substr(0, line.find(' '));
      is_first = false;
    } else if (line.starts_with("Runs in:") || line == "```") {
      in_prose = false;
    } else if (in_prose && !line.starts_with("    ") && !line.starts_with("Source")) {
      found.back().prose += line + "\n";
    }
  }
  return found;
}

/// The headers of the plugin: its formulas and defaults, without its manual.
std::vector<std::string> own_files(const std::string& id) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  for (const auto& kind : fs::directory_iterator(MPM_SOURCE_DIR "/modules"))
    if (fs::is_directory(kind.path() / id))
      for (const auto& file : fs::directory_iterator(kind.path() / id))
        if (file.path().extension() == ".hpp")
          files.push_back("modules/" + kind.path().filename().string() + "/" + id + "/" +
                          file.path().filename().string());
  return files;
}

/// Tests, experiments and shared formulas that have a manual's numbers.
const std::map<std::string, std::vector<std::string>> elsewhere{
    {"bspline_cubic", {"tests/verification/critical_step.cpp"}},
    {"approach", {"tests/verification/detections.cpp"}},
    {"fixed_offset", {"experiments/studies/resting_gap.json"}},
    {"newtonian_fluid", {"modules/kernel/lanes.hpp", "modules/kernel/equation_of_state.hpp", "tests/cli/papers.cpp"}},
    {"snow", {"tests/conformance/snow_paths.cpp"}}};

/// The papers' own numbers, and what everybody knows of water.
const std::map<std::string, std::vector<double>> published{
    {"johnson_cook", {292, 0.31, 0.025, 1.09, 1356, 4340, 792, 510, 0.26, 0.014, 1.03, 1793}},
    {"inviscid_fluid", {2.2}},
    {"newtonian_fluid", {2.2}}};

/// The least and the largest share of its fracture energy that a bar of quadratic B-splines dissipates, as the study has it.
std::vector<double> dissipated_by_cracks() {
  double least = 2, most = 0;
  for (const auto& row : mpm::support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/damage_cells.csv"))
    if (row.size() > 4 && row[0] == "shape: quadratic B-spline" && row[2] == "computed")
      least = smaller(least, std::stod(row[4])), most = larger(most, std::stod(row[4]));
  return {least, most};
}

/// What follows from the plugin's formulas.
std::vector<double> follows(const std::string& id) {
  const double degrees = std::numbers::pi / 180, nu = 0.3, bulk = 1 / 1.2,
               shear = 1 / 2.6;  // of a Young's modulus of 1
  const double elastic = bulk + 4 * shear / 3;
  if (id == "bspline_cubic")
    return {27, 16, 1 / std::sqrt(2)};  // nodes of quadratic and cubic splines, the centre's limit
  if (id == "cpdi") return {27};
  if (id == "mls") return {32};  // f^2 (1 - f)^2 / 2 at f = 1/2
  // (powers of a quadratic spline)^2 - 1 - 2, and so on: what the affine field is not, times the components.
  if (id == "polypic") return {4 * 3, (9 - 3) * 2, 27 - 4, (27 - 4) * 3, 16 - 3, 64 - 4};
  if (id == "fmpm") return {1 / std::sqrt(2), 1 / std::sqrt(8)};
  if (id == "ideal_gas") {
    const double z = std::sqrt(3) * 0.5;  // of the default of C1
    return {z + std::sqrt(z * z + 1), std::floor(std::log(std::numeric_limits<float>::max()))};
  }
  if (id == "snow") return {1 - std::log(100) / 10, 1 + std::log(100) / 10};  // exp(xi (1 - J_P)) with the default xi
  if (id == "newtonian_fluid") return {1 - 0.9 / 1.489};
  if (id == "mie_gruneisen") return {1 - 0.9 / 1.489, 1.9 / 0.9};  // where f of 1 - J = 0.9/s stops to grow
  constexpr double first_of_two_lines = 0.8 / (1 - 1. / 3);        // where it ends over how far it falls, `bilinear`
  if (id == "anisotropic_damage") return {first_of_two_lines};
  if (id == "damage") {
    std::vector<double> shares = dissipated_by_cracks();
    shares.push_back(first_of_two_lines);
    return shares;
  }
  if (id == "cam_clay") {
    const CamClay::Hardening<double> hardening(0, 1, 1.2, 0, shear / bulk);
    return {hardening.at};
  }
  if (id == "drucker_prager") {
    const DruckerPrager::Constants<double> sand({1, nu, 1, 30 * degrees, 0, 1});
    return {100 * (sand.longitudinal / elastic - 1)};
  }
  if (id == "mohr_coulomb") {
    const MohrCoulomb::Constants<double> soil({1, nu, 1, 30 * degrees, 0, 0});
    return {100 * (soil.longitudinal / elastic - 1)};
  }
  return {};
}

bool is_one_of(const PrintedNumber& printed, const std::vector<double>& numbers) {
  return std::any_of(numbers.begin(), numbers.end(), [&](double number) { return number == printed.rounded(); });
}

}  // namespace

// Of one digit alone are numbers that stand everywhere.
TEST_CASE("every number of two digits or more in the manuals stands in the plugin's formulas, or in what has it",
          "[docs]") {
  const std::vector<std::string> names{"[23]-D", "(19|20)[0-9]{2}", "(FMPM|XPIC|CPDI|B)[0-9(]+",
                                       "[A-Z]?[0-9]+:[0-9-]+"};
  int compared = 0;
  std::set<std::string> with_numbers;
  for (const Manual& manual : manuals()) {
    std::vector<std::string> files = own_files(manual.id);
    REQUIRE(!files.empty());
    if (elsewhere.count(manual.id))
      files.insert(files.end(), elsewhere.at(manual.id).begin(), elsewhere.at(manual.id).end());
    const std::vector<double> known = published.count(manual.id) ? published.at(manual.id) : std::vector<double>{};
    for (const PrintedNumber& printed : numbers_in(manual.prose, names)) {
      const std::string digits = std::regex_replace(std::to_string(printed.value), std::regex("^[0.]*|[0.]*$|\\."), "");
      if (digits.size() < 2 || printed.half_unit == 0) continue;
      INFO(manual.id << ": " << printed.value);
      CHECK((stands_in(printed, files) || is_one_of(printed, follows(manual.id)) || is_one_of(printed, known)));
      ++compared, with_numbers.insert(manual.id);
    }
  }
  CHECK(compared > 50);
  CHECK(with_numbers.size() > 15);
}
