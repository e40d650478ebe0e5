// What is no number is not lost where tests look for the largest difference.

#include <filesystem>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("the larger and the smaller of two values keep what is no number", "[support]") {
  const double none = std::numeric_limits<double>::quiet_NaN();
  CHECK(larger(1.0, 2) == 2);
  CHECK(larger(2, 1.0) == 2);
  CHECK(smaller(1.0, 2) == 1);
  CHECK(smaller(2, 1.0) == 1);
  CHECK(larger(-1, -1) == -1);
  for (const double value : {-1.0, 0.0, std::numeric_limits<double>::infinity()}) {
    CHECK(std::isnan(larger(value, none)));
    CHECK(std::isnan(larger(none, value)));
    CHECK(std::isnan(smaller(value, none)));
    CHECK(std::isnan(smaller(none, value)));
  }
}

TEST_CASE("no test looks for the largest or the least of values by std::max or std::min, which lose what is no number",
          "[support]") {
  // A value that is kept, and the same one in the call, first or last of it.
  const std::string kept = R"(((?:[\w.]|->|\(\)|\[[^\]\n]*\])+)\s*=\s*std::f?(?:max|min)(?:<\w+>)?\()";
  const std::regex first(kept + R"(\{?\s*\1,)"), last(kept + R"([^;]*,\s*\1\}?\))");
  const auto loses = [&](const std::string& text) {
    return std::regex_search(text, first) || std::regex_search(text, last);
  };
  for (const char* const wrong :
       {"worst = std::max(worst, std::abs(a - b));", "worst.back() = std::max(worst.back(), x);",
        "skew =\n    std::max(skew, x);", "worst = std::max<double>(worst, distance(P));", "a[k] = std::fmax(a[k], x);",
        "worst = std::max({worst, x, y});", "least = std::min(std::abs(x), least);", "p->low = std::min(p->low, x);"})
    CHECK(loses(wrong));
  CHECK(!loses("worst = larger(worst, std::abs(a - b));"));
  CHECK(!loses("size = std::max(1.0, worst);"));
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(MPM_SOURCE_DIR "/tests")) {
    const std::filesystem::path& path = entry.path();
    if ((path.extension() != ".cpp" && path.extension() != ".hpp") || path.filename() == "larger.cpp") continue;
    // std::regex is slow on whole files: statements with a call are taken one by one.
    const std::string text = support::read_file(path.string());
    for (std::size_t at = text.find("std::"); at != std::string::npos; at = text.find("std::", at + 1)) {
      if (!std::regex_search(text.substr(at, 10), std::regex("^std::f?m(ax|in)"))) continue;
      const std::size_t from = text.find_last_of(";{}", at) + 1, to = text.find(';', at);
      if (loses(text.substr(from, to - from + 1))) found.push_back(path.string() + ": " + text.substr(from, to - from));
    }
  }
  CHECK(found == std::vector<std::string>{});
}
