// Ten blocks on one another at rest for ten seconds. Nothing may move them: no energy but what the weight gave, no drift to a
// side, no sinking, and in each joint the weight of what lies above it.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"
#include "support/stacked_blocks.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double cell = 0.1, width = 0.8, height = 0.2, g = 10, weight = 1000 * width * height * g;
constexpr int blocks = 10;
/// A walk through five fields that takes no pair of them twice: each joint is a pair of its own, and blocks of one field
/// lie three apart.
constexpr int field_of[blocks] = {0, 1, 2, 3, 4, 0, 2, 4, 1, 3};

/// Weight grows over 1.5 s, many periods of the stack, so that it hardly swings. A stack half as wide would buckle: a column
/// of this height stands under its own weight while g < 7.84 E' w^2 / (12 rho H^3), 29 m/s^2 here and 7 there.
std::string stack() {
  std::string bodies;
  for (int k = 0; k < blocks; ++k)
    bodies += std::string(k ? "," : "") + R"({"name": "b)" + std::to_string(k) + R"(", "material": "m", "field": "f)" +
              std::to_string(field_of[k]) + R"(", "geometry": {"type": "box", "lower": [0.4, )" + digits(height * k) +
              R"(], "upper": [1.2, )" + digits(height * (k + 1)) + "]}}";
  return R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [1.6, 2.4]],
      "boundaries": {"all": "free", "y_min": "stick"}}, "shape": {"type": "bspline_quadratic"},
      "transfer": {"type": "apic"}, "contact": {"type": "coulomb", "friction": 0.5, "normal": "widest_gap"},
      "gravity": [0, "-5*(1-cos(pi*t/1.5))*(t<1.5)-10*(t>=1.5)"],
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 5e5, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [)J" +
         bodies + R"(], "solver": {"time_step": "auto", "courant": 0.4, "end_time": 14},
      "output": {"ledger": false, "bodies": true, "contact_pairs": true}})";
}

/// The middles of the blocks, m, and the energy of all, J/m.
struct Stack {
  double x[blocks] = {}, y[blocks] = {}, energy = 0;
};
Stack seen(const Scene& scene) {
  Stack now;
  const Totals totals = scene.metrics.measure();
  now.energy = totals.kinetic + totals.strain;
  for (int k = 0; k < blocks; ++k) {
    const BodyState body = scene.body(k);
    const double count = static_cast<double>(body.position.size()) / 2;
    for (std::size_t p = 0; p < body.position.size(); p += 2)
      now.x[k] += body.position[p] / count, now.y[k] += body.position[p + 1] / count;
    now.energy += weight * now.y[k];
  }
  return now;
}

struct Rest {
  double drift = 0, sunk = 0, risen = 0;  ///< m, the largest of all blocks over ten seconds
  double gained = 0;                      ///< J/m, the most above the energy at their start
  double force = 0;                       ///< the largest error of a joint's mean force, over the weight above it
};
Rest rest(const std::vector<std::string>& settings) {
  Scene scene(stack(), settings);
  const Stack placed = seen(scene);
  while (scene.simulation.time() < 4) scene.simulation.step();
  const Stack start = seen(scene);
  Rest found;
  double pressed[blocks] = {}, samples = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.steps() % 100 != 0) continue;
    const Stack now = seen(scene);
    found.gained = larger(found.gained, now.energy - start.energy);
    for (int k = 0; k < blocks; ++k) {
      found.drift = larger(found.drift, std::abs(now.x[k] - placed.x[k]));
      found.sunk = larger(found.sunk, start.y[k] - now.y[k]);
      found.risen = larger(found.risen, now.y[k] - start.y[k]);
    }
    Numbers numbers = chosen(scene.metrics);
    samples += 1;
    for (int k = 0; k + 1 < blocks; ++k) {
      const int a = std::min(field_of[k], field_of[k + 1]), b = std::max(field_of[k], field_of[k + 1]);
      pressed[k] += numbers.at("pair f" + std::to_string(a) + " f" + std::to_string(b) + " normal force");
    }
  }
  for (int k = 0; k + 1 < blocks; ++k)
    found.force = larger(found.force, std::abs(pressed[k] / samples / (weight * (blocks - 1 - k)) - 1));
  std::printf(
      "Stack of ten, ten seconds: drift %.1e cells, sunk %.1e, risen %.1e, energy gained %.1e J/m, force off %.1e\n",
      found.drift / cell, found.sunk / cell, found.risen / cell, found.gained, found.force);
  return found;
}

/// The energy that the stack has at rest beside its height: sum of W_k^2 H / (2 E A) over the blocks, about 100 J/m.
constexpr double strain_energy() {
  double sum = 0;
  for (int k = 0; k < blocks; ++k) {
    const double above = weight * (blocks - 1 - k);
    sum += (above * above + above * weight + weight * weight / 3) * height / (2 * 5e5 / 0.91 * width);
  }
  return sum;
}

/// `drift` in cells. In float a place is known to 1e-7 of a metre and a velocity of less than that a step is lost, one way for
/// as long as a block leans, for ten thousand steps; the column, which bears a third of what it would buckle by, adds to it.
void check_rest(const Rest& found, double drift = 0.01) {
  CHECK(found.drift < drift * cell);
  CHECK(found.sunk < 0.01 * cell);
  CHECK(found.risen < 0.01 * cell);
  CHECK(found.gained < 1e-3 * strain_energy());
  CHECK(found.force < 0.01);
}

}  // namespace

TEST_CASE("a stack of ten blocks rests for ten seconds with the widest gap", "[stack]") {
  check_rest(rest({}));
}

TEST_CASE("a stack of ten blocks rests for ten seconds with the widest gap in float and with FLIP", "[stack][slow]") {
  check_rest(rest({set("/precision", "float")}), 0.05);
  check_rest(rest({set("/transfer", R"({"type": "flip", "pic_fraction": 0.02})")}));
}

// A known limit: normals lean at the ends of blocks, and friction along them feeds the stack.
TEST_CASE("a stack of ten blocks does not rest with averaged gradients, as the page on contact says", "[stack][slow]") {
  const Rest found = rest({set("/contact/normal", "average_volume_gradient")});
  CHECK(found.gained > strain_energy());
  CHECK(found.force > 0.1);
}
