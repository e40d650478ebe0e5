// Normals of contact between a block and a disc that its weight presses onto it, with its apex on an axis of the grid: the
// angle between them and the surfaces that meet, which the particles' own map to their first places gives. Exact is zero. The
// means are held below three degrees, and to the table of docs/contact.md, whose numbers are the program's own.

#include <cmath>

#include "support/catch.hpp"
#include "support/page.hpp"
#include "support/scene.hpp"
#include "support/stacked_blocks.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Eight cells of 50 mm a radius. The weight grows over 0.1 s, and the motion is damped.
const char* disc = R"J({
  "dimension": 2, "gravity": [0, "-9.81*min(1, t/0.1)"],
  "grid": {"cell_size": 0.05, "domain": [[-1, -0.6], [1, 1.2]], "boundaries": {"all": "free", "y_min": "stick"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "damping": {"viscous": 10},
  "contact": {"type": "frictionless", "normal": "average_volume_gradient"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "block", "material": "m", "geometry": {"type": "box", "lower": [-0.8, -0.6], "upper": [0.8, 0]}},
    {"name": "disc", "material": "m", "geometry": {"type": "ball", "centre": [0, 0.4], "radius": 0.4}}],
  "solver": {"time_step": "auto", "courant": 0.4, "end_time": 0.4},
  "output": {"ledger": false, "bodies": true, "contact_pairs": true, "normal_error": true}})J";

/// Means over the last tenth of a second.
struct Pressed {
  double mean = 0, worst = 0;  ///< degrees: by the force of the nodes; the worst of those with a hundredth of the most
  double force = 0;            ///< N/m
};
Pressed press(const std::string& normal, const std::vector<std::string>& finer) {
  std::vector<std::string> settings{set("/contact/normal", normal)};
  settings.insert(settings.end(), finer.begin(), finer.end());
  Scene scene(disc, settings);
  while (scene.simulation.time() < 0.3) scene.simulation.step();
  Pressed found;
  double samples = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.steps() % 10 != 0) continue;
    const Numbers now = chosen(scene.metrics);
    found.mean += now.at("pair block disc normal error"), found.worst += now.at("pair block disc largest normal error");
    found.force += now.at("pair block disc normal force"), samples += 1;
  }
  found.mean /= samples, found.worst /= samples, found.force /= samples;
  std::printf("  %-26s %-24s mean %.2f, worst %.2f degrees, force %.0f N/m\n", normal.c_str(),
              finer.empty() ? "" : finer[0].c_str(), found.mean, found.worst, found.force);
  return found;
}

const std::vector<std::string> normals{"widest_gap",      "logistic_regression",     "linear_regression",
                                       "volume_gradient", "average_volume_gradient", "mass_gradient"};

/// `column` of the page's table has the means; it was made on one machine, of normals that follow single particles.
void check(const std::vector<std::string>& finer, std::size_t column) {
  const Page page("docs/contact.md");
  for (const std::string& normal : normals) {
    INFO(normal);
    const Pressed found = press(normal, finer);
    CHECK(found.mean < 3);
    CHECK(found.force == Approx(1000 * 9.81 * 0.16 * 3.14159265).epsilon(0.03));  // its weight
    const auto row = page.read("| by `" + normal + "` | #° | #° | #° | #° |");
    CHECK(found.mean == Approx(row[column].value).margin(0.2));
    CHECK(found.worst == Approx(row[column + 1].value).margin(1));
  }
}

}  // namespace

TEST_CASE("normals under a pressed disc are less than three degrees off by their force", "[contact][normals]") {
  std::printf("Normals under a pressed disc, eight cells a radius:\n");
  check({}, 0);
}

TEST_CASE("normals under a pressed disc on half the step and half the cells", "[contact][normals][slow]") {
  std::printf("Normals under a pressed disc:\n");
  check({set("/solver/courant", "0.2")}, 0);
  check({set("/grid/cell_size", "0.025")}, 2);
}
