// What a run holds grows with its particles, and with nothing else.

#include <cstdint>

#include "support/catch.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A cube of `side` cells, 8 particles each, that flies through a domain of `cells` cells an axis.
std::string cube(int side, int cells) {
  const double h = 1.0 / 64, lower = 8 * h, upper = (8 + side) * h;
  const auto corner = [](double x) { return "[" + digits(x) + ", " + digits(x) + ", " + digits(x) + "]"; };
  return R"({"title": "growth", "dimension": 3, "precision": "float", "gravity": [0, 0, -9.81],
    "grid": {"cell_size": )" +
         digits(h) + R"(, "domain": [[0, 0, 0], )" + corner(cells * h) + R"(], "boundaries": {"all": "slip"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "mls"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 4e5, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "cube", "material": "m", "velocity": [11, 7, 5],
                "geometry": {"type": "box", "lower": )" +
         corner(lower) + R"(, "upper": )" + corner(upper) + R"(}}],
    "solver": {"time_step": 1e-4, "end_time": 1},
    "output": {"ledger": false, "metrics_every": 1000000, "frames": 0}})";
}

std::uint64_t bytes_held(const Simulation& simulation) {
  return simulation.backend().particle_bytes() + simulation.backend().grid_bytes();
}

}  // namespace

TEST_CASE("a run holds at most one and a half times its state, sorted again and again", "[stability][growth]") {
  for (const int threads : {1, 2}) {
    CpuRun run(cube(32, 64), {}, threads);
    const std::uint64_t state = run.simulation.particle_count() * run.simulation.plan().bytes_per_particle(0);
    REQUIRE(run.simulation.particle_count() == 32u * 32 * 32 * 8);
    const std::uint64_t first = bytes_held(run.simulation);
    CHECK(first > state);
    CHECK(2 * first <= 3 * state);
    run.steps(60);  // the cube crosses four cells
    INFO(threads << " threads: " << bytes_held(run.simulation) << " bytes for a state of " << state);
    CHECK(2 * bytes_held(run.simulation) <= 3 * state);
  }
}

TEST_CASE("an empty domain costs nothing", "[stability][growth]") {
  CpuRun small(cube(6, 32), {}, 1), large(cube(6, 4096), {}, 1);
  for (CpuRun* run : {&small, &large}) run->steps(3);
  CHECK(bytes_held(large.simulation) == bytes_held(small.simulation));
  const auto position = [](const CpuRun& run) { return run.simulation.backend().body_state(0).position; };
  CHECK(different(position(large), position(small)) == 0);
}
