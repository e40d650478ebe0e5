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

std::string warning(std::vector<std::string> settings) {
  settings.insert(settings.begin(), set("/solver/time_step", "\"auto\""));
  return app::warning_of_tent_steps(
      experiment_from(support::read_file(MPM_SOURCE_DIR "/experiments/lessons/two_discs_one_field.json"), settings));
}

const std::string tents = R"(/shape={"type": "linear"})", aflip = R"(/transfer={"type": "aflip"})";

}  // namespace

TEST_CASE("the schemes that tents are warned with are those that the study found below the limit", "[largest_step]") {
  const std::map<std::string, std::pair<std::string, std::string>> schemes{
      {"PIC", {"pic", ""}},         {"FLIP", {"flip", ""}},      {"AFLIP", {"aflip", ""}},
      {"ASFLIP", {"asflip", ""}},   {"APIC", {"apic", ""}},      {"MLS", {"mls", ""}},
      {"TPIC", {"tpic", ""}},       {"RPIC", {"rpic", ""}},      {"PolyPIC", {"polypic", ""}},
      {"FMPM(4)", {"pic", "fmpm"}}, {"XPIC(4)", {"pic", "xpic"}}};
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
