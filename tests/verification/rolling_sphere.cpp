// A solid sphere on an incline of 30 degrees, from rest: it rolls with a = (5/7) g sin where friction holds it (mu above
// 2 tan / 7), and slides with g (sin - mu cos) where it does not, its rim gathering (5/2) mu g cos. Half of it is there, behind
// its plane of symmetry. `ctest -V` shows the tables.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"
#include "verification/rolling_wheel.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::rolling_wheel;

namespace {

/// The weight grows over many periods in which the sphere swings on its contact; let go of at once it bounces.
const char* sphere = R"J({
  "dimension": 3,
  "grid": {"cell_size": 0.0625, "domain": [[0, 0, -0.25], [2.25, 0.75, 1.25]],
           "boundaries": {"all": "free", "y_min": "slip", "z_min": "stick"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"}, "contact": {"type": "coulomb", "friction": 0.5},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 2e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "sphere", "material": "m", "particles_per_cell_axis": 4, "geometry": {"type": "intersection", "of": [
      {"type": "ball", "centre": [0.7, 0, 0.5], "radius": 0.5}, {"type": "box", "lower": [0, 0, 0], "upper": [2, 0.6, 1]}]}},
    {"name": "ground", "material": "m", "particles_per_cell_axis": 4, "geometry": {"type": "box", "lower": [0.25, 0, -0.25], "upper": [2.25, 0.375, 0]}}],
  "body_force": ["4.905*(0.5*(1-cos(pi*t/0.4))*(t<0.4)+(t>=0.4))", 0, "-8.495709211*(0.5*(1-cos(pi*t/0.4))*(t<0.4)+(t>=0.4))"],
  "solver": {"end_time": 0.8}, "output": {"ledger": false}})J";

/// Velocity along the slope, and speed of the rim: angular momentum about the centre of mass over that of a solid sphere,
/// (2/5) m R^2, times R.
std::pair<double, double> speeds_of_sphere(const BodyState& state) {
  const std::size_t count = state.position.size() / 3;
  double x[3]{}, v[3]{}, spin = 0;
  for (std::size_t k = 0; k < 3 * count; ++k) {
    x[k % 3] += state.position[k] / static_cast<double>(count);
    v[k % 3] += state.velocity[k] / static_cast<double>(count);
  }
  for (std::size_t p = 0; p < count; ++p)
    spin += (state.position[3 * p + 2] - x[2]) * state.velocity[3 * p] -
            (state.position[3 * p] - x[0]) * state.velocity[3 * p + 2];
  return {v[0], spin / static_cast<double>(count) / (0.4 * radius)};
}

Rolling roll_sphere(const std::vector<std::string>& settings) {
  Scene scene(sphere, settings);
  std::vector<double> times, velocities, rims;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.time() < 0.4 || scene.simulation.steps() % 20 != 0) continue;
    const auto [velocity, rim] = speeds_of_sphere(scene.body(0));
    times.push_back(scene.simulation.time()), velocities.push_back(velocity), rims.push_back(rim);
  }
  return {slope(times, velocities), slope(times, rims)};
}

void check_both(const std::string& name, std::vector<std::string> settings, const std::string& friction,
                double within) {
  settings.push_back(set(friction, "0.5"));
  const Rolling rolls = roll_sphere(settings);
  settings.back() = set(friction, "0.1");
  const Rolling slips = roll_sphere(settings);
  std::printf("  %-28s %.4f %.4f | %.4f %.4f\n", name.c_str(), rolls.acceleration, rolls.spin_up, slips.acceleration,
              slips.spin_up);
  INFO(name);
  CHECK(rolls.acceleration == Approx(5 * g * sine / 7).epsilon(within));
  CHECK(rolls.spin_up == Approx(5 * g * sine / 7).epsilon(within));
  CHECK(slips.acceleration == Approx(g * (sine - 0.1 * cosine)).epsilon(within));
  CHECK(slips.spin_up == Approx(2.5 * 0.1 * g * cosine).epsilon(within));
}

void print_head() {
  std::printf(
      "Sphere on an incline (m/s^2): friction 0.5, a and alpha R | 0.1, a and alpha R\n  %-28s %.4f %.4f | %.4f %.4f\n",
      "exact", 5 * g * sine / 7, 5 * g * sine / 7, g * (sine - 0.1 * cosine), 0.25 * g * cosine);
}

}  // namespace

TEST_CASE("a sphere on an incline of its own stuff rolls with five sevenths of g sin, or slips",
          "[friction][rolling]") {
  print_head();
  const std::vector<std::string> coarse{set("/grid/cell_size", "0.083333333333"),
                                        set("/bodies/0/particles_per_cell_axis", "3"),
                                        set("/bodies/1/particles_per_cell_axis", "3")};
  check_both("6 cells a radius", coarse, "/contact/friction", 0.055);
}

TEST_CASE("a sphere of finer cells rolls more exactly", "[friction][rolling][slow]") {
  print_head();
  check_both("8 cells a radius", {}, "/contact/friction", 0.035);
}
