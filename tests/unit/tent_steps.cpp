// The warning of tents with schemes that stood no step, or less than the limit, in the study of largest steps.

#include <map>
#include <string>

#include "run/tent_steps.hpp"
#include "support/catch.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

std::string warning(std::vector<std::string> settings, const std::string& scene = "lessons/two_discs_one_field.json") {
  settings.insert(settings.begin(), set("/solver/time_step", "\"auto\""));
  return app::warning_of_tent_steps(
      experiment_from(support::read_file(MPM_SOURCE_DIR "/experiments/" + scene), settings));
}

const std::string tents = R"(/shape={"type": "linear"})", aflip = R"(/transfer={"type": "aflip"})";

/// Transfer and filter of the studies' schemes.
const std::map<std::string, std::pair<std::string, std::string>> schemes{
    {"PIC", {"pic", ""}},         {"FLIP", {"flip", ""}},       {"AFLIP", {"aflip", ""}},    {"ASFLIP", {"asflip", ""}},
    {"APIC", {"apic", ""}},       {"MLS", {"mls", ""}},         {"TPIC", {"tpic", ""}},      {"RPIC", {"rpic", ""}},
    {"PolyPIC", {"polypic", ""}}, {"FMPM(4)", {"pic", "fmpm"}}, {"XPIC(4)", {"pic", "xpic"}}};

/// What became of five collisions each, by scheme and step; the number is that of the stress update in the study.
std::vector<std::vector<std::string>> collisions(int dimension, int number) {
  return support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/tent_steps_" +
                                 std::string(dimension == 3 ? "3d_" : "") + std::to_string(number) + ".csv");
}

}  // namespace

TEST_CASE("the schemes that tents are warned with are those that the study found below the limit", "[largest_step]") {
  constexpr double limit = 0.1;
  std::size_t found = 0;
  for (const auto& [dimension, name] : {std::pair{2, "largest_step"}, std::pair{3, "largest_step_3d"}})
    for (const auto& row : support::read_csv_cells(MPM_SOURCE_DIR "/figures/studies/" + std::string(name) + ".csv")) {
      if (row[0] != "linear" || !schemes.count(row[1])) continue;
      const double largest = row[2].empty() ? 0 : std::stod(row[2]);
      if (largest >= limit) continue;
      INFO(name << " " << row[1]);
      const auto& [transfer, filter] = schemes.at(row[1]);
      const app::TentStep* listed = nullptr;
      for (const app::TentStep& now : app::tent_steps())
        if (now.dimension == dimension && now.transfer == transfer && now.filter == filter) listed = &now;
      REQUIRE(listed != nullptr);
      CHECK(largest == Approx(listed->largest).margin(0.0005));
      ++found;
    }
  CHECK(found == app::tent_steps().size());
}

TEST_CASE("the collisions that tents are warned with are those that the study counted", "[largest_step]") {
  std::size_t found = 0;
  for (const int dimension : {2, 3})
    for (const auto& [number, update] :
         {std::pair{1, StressUpdate::last}, std::pair{2, StressUpdate::first},
          std::pair{3, StressUpdate::modified_last}, std::pair{4, StressUpdate::averaged}}) {
      std::map<std::string, std::map<double, int>> bounded;
      for (const auto& row : collisions(dimension, number))
        if (schemes.count(row[0])) bounded[row[0]][std::stod(row[1])] = row[2].empty() ? 0 : std::stoi(row[2]);
      REQUIRE(bounded.size() == schemes.size());
      for (const auto& [name, counts] : bounded) {
        INFO(dimension << "-D " << number << " " << name);
        const auto& [transfer, filter] = schemes.at(name);
        const app::TentCollisions* listed = nullptr;
        for (const app::TentCollisions& now : app::tent_collisions())
          if (now.dimension == dimension && now.update == update && now.transfer == transfer && now.filter == filter)
            listed = &now;
        int least = 5;
        for (std::size_t k = 0; k < app::TentCollisions::steps.size(); ++k) {
          const int count = counts.at(app::TentCollisions::steps[k]);
          least = smaller(least, count);
          if (listed != nullptr) CHECK(listed->bounded[k] == count);
        }
        CHECK((listed != nullptr) == (least <= 2));
        found += listed != nullptr;
      }
    }
  CHECK(found == app::tent_collisions().size());
}

// USF and MUSL with what carries no gradient strain by what particles carry.
TEST_CASE("tents stand every step of the study by USF and MUSL with what carries no gradient", "[largest_step]") {
  int rows = 0;
  for (const int dimension : {2, 3})
    for (const int number : {2, 3})
      for (const auto& row : collisions(dimension, number))
        for (const char* scheme : {"PIC", "FLIP", "RPIC", "XPIC(4)", "FMPM(4)"})
          if (row[0] == scheme && (dimension == 3 || row[0] != "FMPM(4)" || std::stod(row[1]) <= 0.2)) {
            INFO(dimension << "-D " << number << " " << scheme << " " << row[1]);
            CHECK(row[2] == "5");
            ++rows;
          }
  CHECK(rows == 2 * (4 * 7 + 5) + 2 * 5 * 7);
}

TEST_CASE("tents are warned of by how many collisions were bounded, at the step that is taken", "[largest_step]") {
  const std::string of_flip = warning({tents, R"(/transfer={"type": "flip"})"});
  INFO(of_flip);
  CHECK(of_flip.find(R"(with transfer "flip" was bounded in 1 of five collisions at courant 0.1, in 4 at 0.0125)") !=
        std::string::npos);
  CHECK(warning({tents, R"(/transfer={"type": "flip"})", set("/solver/courant", "0.06")}).empty());
  const std::string of_mls = warning({tents, R"(/transfer={"type": "mls"})", set("/solver/stress_update", "averaged")});
  INFO(of_mls);
  CHECK(of_mls.find("in 2 of five collisions") != std::string::npos);
  CHECK(warning({tents, R"(/transfer={"type": "pic"})", R"(/filter={"type": "fmpm", "order": 4})"})
            .find("in 0 of five collisions at courant 0.05, in 3 at 0.0125") != std::string::npos);
  const std::string of_balls = warning({tents, aflip}, "extremes/two_balls_scene.json");
  INFO(of_balls);
  CHECK(of_balls.find(R"(with transfer "aflip" was bounded in 2 of five collisions at courant 0.1, in 5 at 0.0125)") !=
        std::string::npos);
}

TEST_CASE("tents with a scheme that stood no step are warned of by name", "[largest_step]") {
  const std::string of_aflip = warning({tents, aflip});
  INFO(of_aflip);
  CHECK(of_aflip.find(R"(shape "linear" with transfer "aflip" stood no step)") != std::string::npos);
  CHECK(of_aflip.find("docs/studies/extremes.md") != std::string::npos);
  const std::string of_pic = warning({tents, R"(/transfer={"type": "pic"})"});
  INFO(of_pic);
  CHECK(of_pic.find("stood courant 0.086 at most") != std::string::npos);
  CHECK(warning({tents, R"(/transfer={"type": "pic"})", R"(/filter={"type": "fmpm", "order": 4})"})
            .find(R"(and filter "fmpm" stood no step)") != std::string::npos);
}

TEST_CASE("other shapes, transfers, orders and steps of one's own are not warned of", "[largest_step]") {
  CHECK(warning({aflip, R"(/shape={"type": "bspline_quadratic"})"}).empty());
  CHECK(warning({tents, R"(/transfer={"type": "apic"})"}).empty());
  CHECK(warning({tents, aflip, set("/solver/stress_update", "modified_last")}).empty());
  CHECK(warning({tents, aflip, set("/solver/time_step", "0.0001")}).empty());
  CHECK(warning({tents, R"(/transfer={"type": "pic"})", set("/solver/courant", "0.08")}).empty());
}
