// Every number of the pages of studies is one of a study's figure, or given: tests/unit/fixtures/page_numbers holds for each
// page its sentences, a # for each number, and where each number comes from:
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
// "tables" are compared in study_pages.cpp, and "given" says of which numbers no run
// decides, and why.

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "experiment/expression.hpp"
#include "study/study.hpp"
#include "support/catch.hpp"
#include "support/csv.hpp"
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

}  // namespace

TEST_CASE("every number of the pages of studies, in digits and in words, is one of a figure, or given", "[docs]") {
  int pages = 0, numbers = 0, words = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MPM_SOURCE_DIR "/tests/unit/fixtures/page_numbers")) {
    const Json list = Json::parse(support::read_file(entry.path()));
    const std::string file = list["page"];
    INFO(file << ", numbers listed in " << entry.path().filename());
    Page page(file);
    if (list.contains("section")) page.keep_from_to(list["section"][0], list["section"][1]);
    for (const Json& table : list.value("tables", Json::array())) page.leave_out_table_after(table["after"]);
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
    for (const Json& group : list["given"]) page.add_given(group["says"]);
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
