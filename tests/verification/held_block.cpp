// A block with ends that friction holds, or stops: on a slope of 30 degrees with friction 0.6, above tan 30 = 0.577, it stays;
// on a flat bed one of the speed v stops after v^2 / (2 mu g) and v / (mu g).

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A block of 0.4 by 0.1 m on a bed, along the grid, with the widest gap.
std::string block(double friction, const std::string& gravity, double speed, double end) {
  return R"J({"dimension": 2, "gravity": )J" + gravity +
         R"J(, "grid": {"cell_size": 0.05, "domain": [[-0.4, -0.2], [1.4, 0.4]],
      "boundaries": {"all": "free", "y_min": "stick"}}, "shape": {"type": "bspline_quadratic"},
      "transfer": {"type": "apic"}, "contact": {"type": "coulomb", "normal": "widest_gap", "friction": )J" +
         digits(friction) +
         R"J(}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [
        {"name": "bed", "material": "m", "geometry": {"type": "box", "lower": [-0.3, -0.2], "upper": [1.3, 0]}},
        {"name": "block", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.4, 0.1]},
         "velocity": [)J" +
         digits(speed) + R"J(, 0]}],
      "solver": {"time_step": "auto", "courant": 0.3, "end_time": )J" +
         digits(end) + R"J(}, "output": {"ledger": false}})J";
}

struct Middle {
  double place = 0, velocity = 0;
};
Middle middle(const Scene& scene) {
  const BodyState state = scene.body(1);
  const double count = static_cast<double>(state.position.size()) / 2;
  Middle found;
  for (std::size_t p = 0; p < state.position.size(); p += 2)
    found.place += state.position[p] / count, found.velocity += state.velocity[p] / count;
  return found;
}

}  // namespace

// It leans and swings while its weight grows; after that it has a second.
TEST_CASE("a block that friction holds creeps by less than a thousandth of a cell in a second", "[friction]") {
  Scene scene(block(0.6, R"J(["4.905*min(1, t/0.1)", "-8.495709211*min(1, t/0.1)"])J", 0, 1.4));
  while (scene.simulation.time() < 0.4) scene.simulation.step();
  const double start = middle(scene).place;
  scene.run();
  std::printf("A held block creeps by %.1e cells in a second\n", (middle(scene).place - start) / 0.05);
  CHECK(std::abs(middle(scene).place - start) < 1e-3 * 0.05);
}

TEST_CASE("a block on a flat bed stops where and when friction says", "[friction]") {
  const double v = 1, mu = 0.3, g = 9.81;
  Scene scene(block(mu, "[0, -9.81]", v, 0.4));
  const double start = middle(scene).place;
  double stopped = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (stopped == 0 && middle(scene).velocity < 0.02 * v) stopped = scene.simulation.time();
  }
  const double way = middle(scene).place - start;
  std::printf("A block stops after %.4f of %.4f m, and is at 2 %% of its speed at %.4f of %.4f s\n", way,
              v * v / (2 * mu * g), stopped, 0.98 * v / (mu * g));
  CHECK(way == Approx(v * v / (2 * mu * g)).epsilon(0.01));
  CHECK(stopped == Approx(0.98 * v / (mu * g)).epsilon(0.02));
}
