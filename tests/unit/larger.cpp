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

TEST_CASE("no test looks for the largest of errors by std::max, which loses what is no number", "[support]") {
  const std::regex loses(
      R"((\w+) = std::max(<double>)?\(\{?\1, (std::)?(abs|fabs|hypot|difference|largest_difference)\()");
  CHECK(std::regex_search("worst = std::max(worst, std::abs(a - b));", loses));
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(MPM_SOURCE_DIR "/tests")) {
    const std::filesystem::path& path = entry.path();
    if ((path.extension() != ".cpp" && path.extension() != ".hpp") || path.filename() == "larger.cpp") continue;
    if (std::regex_search(support::read_file(path.string()), loses)) found.push_back(path.string());
  }
  CHECK(found == std::vector<std::string>{});
}
