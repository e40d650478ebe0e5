// docs/method.md prints how long a step each shape stands, which the shapes state, and in which order the passes of a step
// come, which the plan has.

#include <array>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "plan/plan.hpp"
#include "plugin/extension_of.hpp"
#include "support/catch.hpp"
#include "support/page.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("the largest Courant numbers on the page of the method are those of the shapes", "[docs][largest_step]") {
  const Page page("docs/method.md");
  int shapes = 0;
  for (const Plugin* shape : plugins().of_kind(MPM_SHAPE)) {
    const auto* states = extension_of<mpm_shape_courant_limit>(*shape);
    REQUIRE(states != nullptr);
    INFO(shape->id());
    const auto printed = page.read("| `" + std::string(shape->id()) + "` | # · # | # · # | # · # |");
    for (const int dimension : {2, 3})
      for (int velocity = 0; velocity < MPM_STRAIN_VELOCITIES; ++velocity) {
        INFO(dimension << "-D, column " << velocity);
        CHECK(states->limit[dimension - 2][velocity] ==
              Approx(printed.at(static_cast<std::size_t>(2 * velocity + dimension - 2)).value).epsilon(1e-12));
      }
    ++shapes;
  }
  CHECK(shapes == 8);
}

namespace {

const char* const pressed_blocks = R"J({
  "title": "two blocks", "dimension": 2,
  "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "slip"}},
  "shape": {"type": "cpdi"}, "transfer": {"type": "flip"}, "contact": {"type": "coulomb", "friction": 0},
  "materials": {"a": {"type": "neo_hookean", "density": 1000, "youngs_modulus": 1e4, "poisson_ratio": 0.2}},
  "bodies": [{"name": "lower", "material": "a", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 0.5]}},
             {"name": "upper", "material": "a", "geometry": {"type": "box", "lower": [0, 0.5], "upper": [1, 1]}}],
  "solver": {"time_step": "auto", "end_time": 1}
})J";

/// What `mpm plan` prints of the passes of a step, a line each, of a scene that is not fused.
std::vector<std::string> passes_with(const std::string& update) {
  const Plan plan = make_plan(experiment_from(pressed_blocks, {set("/solver/stress_update", update)}));
  std::istringstream text(plan.to_text());
  std::vector<std::string> passes;
  bool begun = false;
  for (std::string line; std::getline(text, line); begun = begun || line == "Passes of a step")
    if (begun && line.starts_with("    ")) passes.push_back(line.substr(4));
  return passes;
}

}  // namespace

TEST_CASE("the passes of a step stand on the page of the method in the order in which the plan has them", "[docs]") {
  const std::string file = support::read_file(MPM_SOURCE_DIR "/docs/method.md");
  const std::string table =
      file.substr(file.find("## One step"), file.find("### Pictures of a step") - file.find("## One step"));
  const std::regex row("\\n\\| (`[^|]*`) \\|[^|]*\\| ([0-9–]+) \\| ([0-9–]+) \\| ([0-9–]+) \\| ([0-9–]+) \\|");
  const std::array<std::string, 4> updates{"last", "first", "modified_last", "averaged"};
  std::array<std::map<std::size_t, std::string>, 4> names;  // of each number of the table
  for (std::sregex_iterator match(table.begin(), table.end(), row), end; match != end; ++match)
    for (std::size_t k = 0; k < 4; ++k)
      if (const std::string number = (*match)[2 + k]; number != "–") names[k][std::stoul(number)] = (*match)[1];
  for (std::size_t k = 0; k < 4; ++k) {
    const std::vector<std::string> passes = passes_with(updates[k]);
    INFO(updates[k]);
    REQUIRE(passes.size() == names[k].size());
    for (std::size_t pass = 0; pass < passes.size(); ++pass) {
      const std::string printed = passes[pass].substr(0, passes[pass].find("  "));
      INFO(pass + 1 << ": " << printed << " is none of " << names[k][pass + 1]);
      CHECK(names[k][pass + 1].find("`" + printed + "`") != std::string::npos);
    }
  }
  const Page page("docs/method.md");
  for (const char* const says : {"wave and particle speeds give dt, every # steps", "renewed every # steps"}) {
    const std::string every = "every " + std::to_string(std::lround(page.read(says).front().value)) + " steps";
    CHECK(passes_with("last").front().find(every) != std::string::npos);
  }
}
