// Says how closely tests hold. With the environment variable MPM_DISTANCES a suite's program writes a line for each test
// case to the file of that name: its file, its name, the number of its assertions, the largest relative distance of a
// found from an expected value (a == Approx(b), but for values near zero that a margin holds), and the largest share of a bound that was used (a < b). A field is empty
// where a case has no such assertion. docs/generate_verified.sh makes a page of these lines.

#if !__has_include(<catch2/catch_all.hpp>)
#define CATCH_CONFIG_EXTERNAL_INTERFACES
#endif
#include "support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

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
    Catch::StringMaker<double>::precision = Catch::StringMaker<float>::precision = 30;  // decimals: rounding shows too
    assertions_ = 0;
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
    std::ofstream out(std::getenv("MPM_DISTANCES"), std::ios::app);
    const auto field = [](const std::optional<double>& value) {
      std::ostringstream text;
      text.precision(2);
      if (value) text << *value;
      return text.str();
    };
    out << file.substr(file.rfind("tests/")) << '\t' << name << '\t' << assertions_ << '\t' << field(distance_) << '\t'
        << field(share_) << '\n';
    Listener::testCaseEnded(stats);
  }

 private:
  void take(const Catch::AssertionResult& result) {
    ++assertions_;
    if (!result.hasExpandedExpression()) return;
    std::string text = result.getExpandedExpression();
    std::replace(text.begin(), text.end(), '\n', ' ');  // long numbers stand on lines of their own
    for (const std::string sign : {" == ", " <= ", " >= ", " < ", " > "}) {
      const std::size_t at = text.find(sign);
      if (at == text.npos || text.find(sign, at + 1) != text.npos) continue;
      const auto left = number(text.substr(0, at)), right = number(text.substr(at + sign.size()));
      if (!left || !right) return;
      if (sign == " == ") {
        const double distance = apart(*left, *right);
        // What holds although it is half of its value away is a value near zero, which a margin holds.
        const bool by_margin = result.succeeded() && distance >= 0.5;
        return text.find("Approx") == text.npos || by_margin ? void() : keep(distance_, distance);
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
  std::optional<double> distance_, share_;
};

const bool listens = [] {
  if (!std::getenv("MPM_DISTANCES")) return false;
#if __has_include(<catch2/catch_all.hpp>)
  static const Catch::ListenerRegistrar<Distances> registrar("distances");
#else
  static const Catch::ListenerRegistrar<Distances> registrar;
#endif
  return true;
}();

}  // namespace
