// What the launcher `mpm` says of supported releases against the README's table of what was tried on each.
#include <regex>
#include <string>

#include "support/catch.hpp"
#include "support/files.hpp"

namespace {

std::string text_of(const std::string& file) {
  return mpm::support::read_file(std::string(MPM_SOURCE_DIR "/") + file);
}

void append(std::string& list, const std::string& release) {
  list += (list.empty() ? "" : ", ") + release;
}

/// The launcher's words for the table: a release counts as tested where all of its tests passed with its own g++.
std::string words_for_table(const std::string& page) {
  const std::regex row(R"(\n\| ((?:Debian|Ubuntu) [0-9.]+) \| (g\+\+ [0-9.]+|-) \| [0-9-]+ \| ([^\n]*) \|)");
  const std::regex passed(".*\\b([0-9]+) of \\1 tests passed.*");
  std::string tested, failed, not_tried;
  for (std::sregex_iterator match(page.begin(), page.end(), row), end; match != end; ++match) {
    const std::string result = (*match)[3];
    const bool tried = result.find("not tried") == std::string::npos;
    append(!tried ? not_tried : std::regex_match(result, passed) ? tested : failed, (*match)[1]);
  }
  std::string words;
  for (const auto& [list, state] :
       {std::pair{&tested, "tested"}, std::pair{&failed, "tests fail"}, std::pair{&not_tried, "not tried"}})
    if (!list->empty()) words += (words.empty() ? "" : "; ") + *list + " (" + state + ")";
  return words + ".";
}

}  // namespace

TEST_CASE("the launcher names the releases as the README's table of trials does", "[docs]") {
  const std::string launcher = text_of("mpm");
  std::smatch supported;
  REQUIRE(std::regex_search(launcher, supported, std::regex("\nsupported=\"([^\"]*)\"")));
  CHECK(supported[1] == words_for_table(text_of("README.md")));
}

TEST_CASE("the words for a table of trials", "[docs]") {
  const std::string head = "\n| release | compiler | date | result |\n|---|---|---|---|";
  const std::string good =
      "\n| Debian 12 | g++ 12.2.0 | 2026-11-23 | quickstart 0.9, 7 of 7 tests passed, on a bare system |";
  const std::string bad = "\n| Debian 13 | g++ 14.2.0 | 2026-11-23 | quickstart 0.9, 6 of 7 tests passed |";
  const std::string none = "\n| Ubuntu 24.04 | - | 2026-11-23 | packages not reachable, not tried |";
  const std::string other = "\n| Debian 11 | clang++ 14.0.6 | 2026-11-24 | quickstart 0.9, 5 of 5 quick tests passed |";
  CHECK(words_for_table(head + good + none + other + "\n") == "Debian 12 (tested); Ubuntu 24.04 (not tried).");
  CHECK(words_for_table(head + good + bad + "\n") == "Debian 12 (tested); Debian 13 (tests fail).");
}
