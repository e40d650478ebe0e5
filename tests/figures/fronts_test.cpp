// Fronts of studies as figures and tables.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>

#include "study/figures.hpp"
#include "study/results.hpp"
#include "support/catch.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::study;

TEST_CASE("a front in a crowd is numbered, and its table names every point and what dominates it", "[study]") {
  std::string values = "0";
  for (int k = 1; k < 120; ++k) values += ", " + std::to_string(k);
  Results results;
  results.study = read_study_text(R"J({"base": "b", "axes": {"/a": [)J" + values +
                                      R"J(]}, "measure": {"e": "/e"}, "error": "e",
                                      "figures": [{"type": "pareto", "costs": ["flops"], "name": "crowd"}]})J",
                                  "s.json");
  for (const Combination& combination : expand(results.study)) {  // 0, 1 and 2 are the front, the others behind 0
    const double k = static_cast<double>(results.results.size());
    Result result;
    result.combination = combination;
    result.outcome = {Status::done, "", false};
    result.measures = {{"flops", 10 + k}, {"e", k < 3 ? 9 - 3 * k : 7 + k}};
    results.results.push_back(result);
  }
  const test::TemporaryFolder folder;
  CHECK(draw_figures(results, folder.path()).empty());
  const auto text_of = [&](const char* name) {
    std::ifstream file(folder / "figures" / name);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string table = text_of("crowd_flops.csv"), picture = text_of("crowd_flops.svg");
  for (const char* row : {",10,9,,1,0,\n", ",11,6,,2,1,\n", ",12,3,,3,2,\n", ",13,10,,,3,0\n", ",129,126,,,119,0\n"}) {
    INFO(row);
    CHECK(table.find(row) != std::string::npos);
  }
  CHECK(picture.find("front: 1:\u00a00 · 2:\u00a01 · 3:\u00a02") != std::string::npos);
}

TEST_CASE("numbers of a front stand apart in every figure of the studies", "[docs]") {
  const std::regex number(
      "<text font-size=\"([0-9.]+)\"[^>]*text-anchor=\"middle\" x=\"([0-9.]+)\" y=\"([0-9.]+)\">([0-9]+)</text>");
  struct Place {
    std::string text;
    double x, y, width, height;
  };
  int fronts = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MPM_SOURCE_DIR "/figures/studies")) {
    if (!entry.path().filename().string().ends_with("_flops.svg")) continue;
    std::ifstream file(entry.path());
    const std::string picture(std::istreambuf_iterator<char>(file), {});
    if (picture.find("front: 1:") == std::string::npos) continue;
    ++fronts;
    INFO(entry.path().filename());
    std::vector<Place> places;
    for (std::sregex_iterator found(picture.begin(), picture.end(), number), end; found != end; ++found) {
      const std::string text = (*found)[4];
      const double size = std::stod((*found)[1]);  // digits are half as wide and 0.7 times as high
      places.push_back({text, std::stod((*found)[2]), std::stod((*found)[3]),
                        0.5 * size * static_cast<double>(text.size()), 0.7 * size});
    }
    CHECK(places.size() >= 5);
    for (std::size_t k = 0; k < places.size(); ++k)
      for (std::size_t other = 0; other < k; ++other) {
        const Place &a = places[k], &b = places[other];
        INFO(a.text << " and " << b.text);
        CHECK((std::abs(a.x - b.x) > (a.width + b.width) / 2 || std::abs(a.y - b.y) > a.height));
      }
  }
  CHECK(fronts >= 3);
}
