// The gap at which each detection lets two faces touch, against what it is made of: weights of rows of particles, written
// here once more.

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double h = 0.05, half_row = 0.25;  // m; cells from a face to its first row of particles, two a cell

/// A block that falls onto one at rest, in a shaft, at a hundredth of a cell a step. The lower one's face lies `place` cells
/// above a node.
std::string falling_block(const std::string& detection, double place) {
  const double face = 0.4 + place * h, above = face + 3 * h;
  return R"J({"dimension": 2, "grid": {"cell_size": 0.05, "domain": [[0, 0], [0.4, 1.2]], "boundaries": {"all": "slip"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "contact": {"type": "coulomb", "friction": 0, "detection": )J" +
         detection + R"J(},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e4, "poisson_ratio": 0, "density": 1000}},
    "bodies": [{"name": "below", "material": "m", "seeding": "fitted",
                "geometry": {"type": "box", "lower": [0, )J" +
         digits(face - 0.2) + R"J(], "upper": [0.4, )J" + digits(face) + R"J(]}},
               {"name": "above", "material": "m", "seeding": "fitted", "velocity": [0, -1],
                "geometry": {"type": "box", "lower": [0, )J" +
         digits(above) + R"J(], "upper": [0.4, )J" + digits(above + 0.2) + R"J(]}}],
    "solver": {"time_step": 0.0005, "end_time": 0.2}})J";
}

/// Between the faces of both blocks, cells.
double gap_of(const Scene& scene) {
  double top = -1, bottom = 99;
  const BodyState below = scene.body(0), above = scene.body(1);
  for (std::size_t i = 1; i < below.position.size(); i += 2) top = larger(top, below.position[i] / h);
  for (std::size_t i = 1; i < above.position.size(); i += 2) bottom = smaller(bottom, above.position[i] / h);
  return bottom - top - 2 * half_row;
}

/// The gap at which the blocks first push one another, cells.
double gap_at_touch(const std::string& backend, const std::string& detection, double place) {
  Scene scene(falling_block(detection, place), {set("/backend", backend)});
  REQUIRE(gap_of(scene) == Approx(3));
  while (scene.simulation.time() < 0.19) {
    const double gap = gap_of(scene);
    scene.run_steps(1);
    if (scene.simulation.backend().contact_record().force[1] != 0) return gap;
  }
  return NAN;
}

double weight(double x) {
  const double d = std::abs(x);
  return d >= 1.5 ? 0 : d < 0.5 ? 0.75 - d * d : 0.5 * (1.5 - d) * (1.5 - d);
}

/// The mass that a node at zero sees of a block with its face at `face`, in rows, and its mean place.
struct SeenRows {
  double mass = 0, mean = 0;
  explicit SeenRows(double face) {
    for (int k = 0; k < 8; ++k) {
      const double row = face - half_row - 0.5 * k;
      mass += weight(row), mean += weight(row) * row;
    }
    mean /= mass;
  }
};

/// The widest gap at which some node sees enough of both blocks and their means are at most `offset` apart.
double widest_gap(double place, double offset) {
  for (double gap = 3; gap > -1; gap -= 1e-4)
    for (int node = -3; node <= 4; ++node) {
      const SeenRows a(place - node), b(node - place - gap);
      if (!(std::min(a.mass, b.mass) >= 1e-5 * (a.mass + b.mass))) continue;  // operators/contact_geometry.hpp
      if (-b.mean - a.mean <= offset) return gap;
    }
  return NAN;
}

}  // namespace

TEST_CASE("faces touch at the gap which the detection says", "[contact][detections]") {
  constexpr double step = 0.011;  // cells in which they come nearer within a step, and a tenth of that
  for (const std::string backend : {"reference", "cpu"})
    for (const double place : {0.0, 0.2, 0.5, 0.7}) {
      INFO(backend << ", face " << place << " cells above a node");
      CHECK(gap_at_touch(backend, R"("approach")", place) == Approx(widest_gap(place, 99)).margin(step));
      for (const double offset : {0.67, 0.8, 1.0})
        CHECK(gap_at_touch(backend, R"({"type": "fixed_offset", "offset": )" + digits(offset) + "}", place) ==
              Approx(widest_gap(place, offset)).margin(step));
      CHECK(gap_at_touch(backend, R"("particle_surfaces")", place) == Approx(0).margin(step));
      CHECK(gap_at_touch(backend, R"("approach_and_position")", place) == Approx(0).margin(step));
    }
}
