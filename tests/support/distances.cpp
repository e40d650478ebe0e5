// Says how closely tests hold. With the environment variable MPM_DISTANCES a suite's program writes a line for each test
// case to the file of that name: its file, its name, the number of its assertions, the largest relative distance of a
// found from an expected value (a == Approx(b), but for values near zero that a margin holds), and the largest share of a bound that was used (a < b). A field is empty
// where a case has no such assertion. docs/generate_verified.sh makes a page of these lines.
//
// With MPM_VERIFIED, the path of that page, the program compares each case that it runs with the case's row and fails where
// the row is off; tests/CMakeLists.txt sets it for every CTest entry. The page says how near they must be.

#if !__has_include(<catch2/catch_all.hpp>)
#define CATCH_CONFIG_EXTERNAL_INTERFACES
#endif
#include "support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

#if __has_include(<catch2/catch_all.hpp>)
using Listener = Catch::EventListenerBase;
#else
using Listener = Catch::TestEventListenerBase;
#endif

std::optional<double> number(std::string text) {
  if (const std::size_t open = text.find("Approx( "); open != text.npos) text = text.substr(open + 8);
  std::size_t end = 0;
  try {
    const double value = std::stod(text, &end);
    while (end < text.size() && (text[end] == 'f' || text[end] == ' ' || text[end] == ')')) ++end;
    if (end == text.size()) return value;
  } catch (const std::exception&) {  // this is no number
  }
  return {};
}

/// A row of the page: assertions, apart, bound used.
using Row = std::vector<std::string>;

/// Rows of the page by file and case; those of slow cases without the day of their run.
std::map<std::pair<std::string, std::string>, Row> rows_of_page(const char* path) {
  std::map<std::pair<std::string, std::string>, Row> rows;
  std::ifstream page(path);
  std::string file;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("## `", 0) == 0) file = line.substr(4, line.find('`', 4) - 4);
    if (line.rfind("| ", 0) != 0) continue;
    std::vector<std::string> cells;
    std::string cell;
    for (std::size_t k = 1; k < line.size(); ++k) {
      if (line[k] == '|') {
        const std::size_t from = cell.find_first_not_of(' '), to = cell.find_last_not_of(' ');
        cells.push_back(from == cell.npos ? "" : cell.substr(from, to - from + 1));
        cell.clear();
      } else if (line[k] == '\\' && k + 1 < line.size() && line[k + 1] == '|') {
        cell += line[++k];
      } else {
        cell += line[k];
      }
    }
    if (cells.size() != 4 || cells[0].find("(slow, not run yet)") != cells[0].npos) continue;
    const std::string name = cells[0].substr(0, cells[0].rfind(" (slow, run of "));
    rows[{file, name}] = {cells[1], cells[2], cells[3]};
  }
  return rows;
}

/// Whether a number is at most four times as large as that of the page. Both count as `least` where they are less. An empty
/// field is not compared: whether the farthest value is held by its margin may be a matter of rounding.
bool is_as_near(const std::string& page, const std::string& now, double least) {
  if (page == now) return true;
  const auto a = number(page), b = number(now);
  if (!a || !b) return true;
  const double x = std::max(*a, least), y = std::max(*b, least);
  return y <= 4 * x;
}

int rows_off = 0;

/// Says what is off in the row of a case. The program fails when it ends.
void compare_with_page(const std::string& file, const std::string& name, const Row& now) {
  static const auto rows = rows_of_page(std::getenv("MPM_VERIFIED"));
  const auto found = rows.find({file, name});
  if (found == rows.end()) return;  // unit.verification_page says which are missing
  static const char* const columns[] = {"assertions", "apart", "bound used"};
  static const double least[] = {1, 1e-9, 0.05};  // below are rounding, and shares of a bound that is far away
  for (std::size_t k = 1; k < now.size(); ++k) {  // numbers of assertions differ between machines
    if (is_as_near(found->second[k], now[k], least[k])) continue;
    if (++rows_off == 1)
      std::atexit([] {
        std::fflush(nullptr);
        std::_Exit(1);
      });
    std::fprintf(stderr, "docs/verified.md is off: %s, \"%s\": %s is \"%s\" there and \"%s\" now\n", file.c_str(),
                 name.c_str(), columns[k], found->second[k].c_str(), now[k].c_str());
  }
}

class Distances : public Listener {
 public:
  using Listener::Listener;
#if __has_include(<catch2/catch_all.hpp>)
  explicit Distances(const Catch::IConfig* config) : Listener(config) {
    m_preferences.shouldReportAllAssertions = true;
  }
#endif

  void testCaseStarting(const Catch::TestCaseInfo& info) override {
    Listener::testCaseStarting(info);
    assertions_ = 0;
    failed_ = skipped_ = false;
    distance_.reset(), share_.reset();
  }

#if __has_include(<catch2/catch_all.hpp>)
  void assertionEnded(const Catch::AssertionStats& stats) override {
    take(stats.assertionResult);
  }
#else
  bool assertionEnded(const Catch::AssertionStats& stats) override {
    take(stats.assertionResult);
    return false;
  }
#endif

  void testCaseEnded(const Catch::TestCaseStats& stats) override {
#if __has_include(<catch2/catch_all.hpp>)
    const std::string name = stats.testInfo->name, file = stats.testInfo->lineInfo.file;
#else
    const std::string name = stats.testInfo.name, file = stats.testInfo.lineInfo.file;
#endif
    const auto field = [](const std::optional<double>& value) {
      std::ostringstream text;
      text.precision(2);
      if (value) text << *value;
      return text.str();
    };
    const std::string place = file.substr(file.rfind("tests/"));
    const Row row{std::to_string(assertions_), field(distance_), field(share_)};
    if (const char* path = std::getenv("MPM_DISTANCES"))
      std::ofstream(path, std::ios::app) << place << '\t' << name << '\t' << row[0] << '\t' << row[1] << '\t' << row[2]
                                         << '\n';
    if (std::getenv("MPM_VERIFIED") && !failed_ && !skipped_) compare_with_page(place, name, row);
    Listener::testCaseEnded(stats);
  }

 private:
  void take(const Catch::AssertionResult& result) {
    ++assertions_;
    skipped_ = skipped_ || result.getResultType() == Catch::ResultWas::Warning;  // how cases say what they left out
    failed_ = failed_ || !result.succeeded();
    if (!result.succeeded()) return;  // a failure is told with its usual digits
    auto &of_double = Catch::StringMaker<double>::precision, &of_float = Catch::StringMaker<float>::precision;
    const auto double_before = of_double, float_before = of_float;
    of_double = of_float = 30;  // decimals: rounding shows too
    std::string text = result.hasExpandedExpression() ? result.getExpandedExpression() : "";
    of_double = double_before, of_float = float_before;
    std::replace(text.begin(), text.end(), '\n', ' ');  // long numbers stand on lines of their own
    for (const std::string sign : {" == ", " <= ", " >= ", " < ", " > "}) {
      const std::size_t at = text.find(sign);
      if (at == text.npos || text.find(sign, at + 1) != text.npos) continue;
      const auto left = number(text.substr(0, at)), right = number(text.substr(at + sign.size()));
      if (!left || !right) return;
      if (sign == " == ") {
        const double distance = apart(*left, *right);
        // What holds although it is half of its value away is a value near zero, which a margin holds.
        return text.find("Approx") == text.npos || distance >= 0.5 ? void() : keep(distance_, distance);
      }
      const bool below = sign[1] == '<';
      const double found = below ? *left : *right, bound = below ? *right : *left;
      return found >= 0 && bound > 0 ? keep(share_, found / bound) : void();
    }
  }
  static double apart(double found, double expected) {
    return std::abs(found - expected) / (expected != 0 ? std::abs(expected) : 1);
  }
  static void keep(std::optional<double>& largest, double value) {
    if (!largest) largest = 0;
    if (!std::isnan(*largest) && !(value <= *largest)) largest = value;  // one that is no number stays
  }

  long assertions_ = 0;
  bool failed_ = false, skipped_ = false;
  std::optional<double> distance_, share_;
};

const bool listens = [] {
  if (!std::getenv("MPM_DISTANCES") && !std::getenv("MPM_VERIFIED")) return false;
#if __has_include(<catch2/catch_all.hpp>)
  static const Catch::ListenerRegistrar<Distances> registrar("distances");
#else
  static const Catch::ListenerRegistrar<Distances> registrar;
#endif
  return true;
}();

}  // namespace
