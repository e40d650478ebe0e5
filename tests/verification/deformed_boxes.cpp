// cpGIMP: the box that follows the deformation, in runs. What a quarter turn does to it by diag F and by diag U, what a
// large stretch does, and where it ends.

#include <cmath>

#include "shapes/gimp_contiguous/gimp_contiguous.hpp"
#include "support/catch.hpp"
#include "support/lesson.hpp"
#include "support/scene.hpp"
#include "support/stretched_bar.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::vector<std::string> backends{"reference", "cpu"};

const char* spinning = R"J({
  "title": "quarter turn", "dimension": 2, "precision": "double", "backend": "cpu",
  "constants": {"w": 6.283185307179586},
  "grid": {"cell_size": 0.05, "domain": [[0, 0], [1.6, 1.6]], "boundaries": {"all": "free"}},
  "shape": {"type": "gimp_contiguous"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 9.869604401e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "disc", "material": "m", "geometry": {"type": "ball", "centre": [0.8, 0.8], "radius": 0.3},
              "velocity": ["-w*(y-0.8)", "w*(x-0.8)"]}],
  "solver": {"time_step": "auto", "courant": 0.4, "end_time": 0.25}, "output": {"ledger": false}})J";

/// The body is without stress and drawn out along x at a constant rate: F_xx = 1 + 2 t.
const char* drawn = R"J({
  "title": "drawn out", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [8, 1]], "boundaries": {"all": "slip"}},
  "shape": {"type": "gimp_contiguous"}, "transfer": {"type": "tpic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1000}},
  "bodies": [{"name": "bar", "material": "m", "geometry": {"type": "box", "lower": [1, 0.3], "upper": [1.4, 0.7]}, "velocity": ["2*x", 0]}],
  "solver": {"time_step": 0.001, "end_time": 3}, "output": {"ledger": false}})J";

/// The smallest and largest half length of the boxes of a body, in cells.
std::pair<double, double> half_lengths(const BodyState& state, double cell_size, double stretch_by) {
  std::pair<double, double> range{1e9, 0};
  for (std::size_t k = 0; k < state.domain.size(); k += 4) {
    Mat<2, double> domain;
    for (int c = 0; c < 4; ++c) domain.m[c] = state.domain[k + static_cast<std::size_t>(c)] / cell_size;
    const Vec<2, double> l = GimpContiguous::half_lengths<2>({stretch_by}, domain);
    for (int a = 0; a < 2; ++a) range = {std::min(range.first, l[a]), std::max(range.second, l[a])};
  }
  return range;
}

}  // namespace

TEST_CASE("a quarter turn of a disc collapses the boxes of diag F and leaves those of diag U", "[gimp_contiguous]") {
  for (const std::string stretch_by : {"deformation_gradient", "right_stretch"}) {
    Scene scene(spinning, {R"(/shape={"type":"gimp_contiguous","stretch_by":")" + stretch_by + "\"}"});
    const auto start_F = half_lengths(scene.body(), 0.05, 0), start_U = half_lengths(scene.body(), 0.05, 1);
    CHECK(start_F.first == Approx(0.25));
    CHECK(start_U.second == Approx(0.25));
    scene.run();
    const auto end_F = half_lengths(scene.body(), 0.05, 0), end_U = half_lengths(scene.body(), 0.05, 1);
    INFO(stretch_by << ": diag F up to " << end_F.second << ", diag U from " << end_U.first);
    CHECK(end_F.second < 0.01);
    CHECK(end_U.first == Approx(0.25).epsilon(0.01));
    CHECK(end_U.second == Approx(0.25).epsilon(0.01));
  }
}

TEST_CASE("the box follows a stretch, and a run stops by name where four nodes do not hold it", "[gimp_contiguous]") {
  struct End {
    std::string cause;
    std::size_t particle = 0;
    long step = 0;
  };
  const auto run_to_end = [](const std::string& backend, const std::string& passes, const std::string& stretch_by) {
    Scene scene(drawn, {set("/backend", backend), set("/solver/passes", passes),
                        R"(/shape={"type":"gimp_contiguous","stretch_by":")" + stretch_by + "\"}"});
    End end;
    try {
      scene.run();
    } catch (const RunFailure& stopped) {
      end = {cause_text(stopped.failure, scene.experiment), stopped.failure.particle, scene.simulation.steps()};
    }
    // The longest box is two cells long, and longer by no more than one step's stretch.
    const double longest = half_lengths(scene.body(), 0.1, 0).second;
    CHECK(longest > 1);
    CHECK(longest < 1.003);
    return end;
  };
  for (const std::string stretch_by : {"deformation_gradient", "right_stretch"}) {
    const End reference = run_to_end("reference", "separate", stretch_by);
    CHECK(reference.cause == "its domain has grown too long for the 4 nodes an axis of shape \"gimp_contiguous\"");
    CHECK(reference.step > 1000);
    for (const std::string passes : {"separate", "fused"}) {
      const End cpu = run_to_end("cpu", passes, stretch_by);
      INFO(passes << " " << stretch_by);
      CHECK(cpu.cause == reference.cause);
      CHECK(cpu.particle == reference.particle);
      CHECK(cpu.step == reference.step);
    }
  }
}

TEST_CASE("a bar that is thrown from its clamp does not come apart while contiguous boxes are shorter than a cell",
          "[gimp_contiguous]") {
  // The bar is that of lesson 5, stretched by 4.
  const double exact = bar_by_finite_differences(8, 10, 1, {0.77}).front();
  const auto last = [](const std::string& shape, const std::string& particles) {
    Lesson bar("stretched_bar_gimp", {"/shape=" + shape, set("/bodies/0/particles_per_cell_axis", particles)});
    Totals now;
    while (!bar.simulation.finished()) now = bar.step();
    INFO(shape << ", " << particles << " particles: centre of mass at " << now.centre_of_mass[0]);
    CHECK(bar.largest_volume_ratio > 3);
    return std::pair{now.centre_of_mass[0], kept_energy(bar, now)};
  };
  const std::string by_F = R"({"type":"gimp_contiguous"})",
                    by_U = R"({"type":"gimp_contiguous","stretch_by":"right_stretch"})";
  for (const std::string& shape : {by_F, by_U}) {
    const auto [centre, energy] = last(shape, "4");
    CHECK(centre == Approx(exact).margin(0.0035));
    CHECK(energy <= 1);
    CHECK(energy > 0.998);
  }
  CHECK(last(R"({"type":"gimp"})", "4").first > 2);  // the bar is in pieces
  CHECK(last(by_F, "2").first > 1.5);                // boxes of up to two cells leave it in pieces too
}
