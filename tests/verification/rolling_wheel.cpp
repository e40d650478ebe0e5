// A solid cylinder on an incline of 30 degrees, from rest: it rolls with a = (2/3) g sin where friction holds it (mu above
// tan / 3), and slides with g (sin - mu cos) where it does not, turning with 2 mu g cos / R. The slope is aligned with the
// grid. `ctest -V` shows the tables.

#include <cmath>

#include "support/catch.hpp"
#include "verification/rolling_wheel.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::rolling_wheel;

namespace {

/// Runs both cases; `within` is a share of the exact accelerations, `seen` the share of the spin that is in the velocities.
void check_both(const std::string& name, std::vector<std::string> settings, double within, double seen = 1) {
  settings.push_back(set("/contact/friction", "0.5"));
  const Rolling rolls = roll(settings);
  settings.back() = set("/contact/friction", "0.15");
  const Rolling slips = roll(settings);
  std::printf("  %-24s %.4f %.4f | %.4f %.4f\n", name.c_str(), rolls.acceleration, rolls.spin_up, slips.acceleration,
              slips.spin_up);
  INFO(name);
  CHECK(rolls.acceleration == Approx(3.27).epsilon(within));
  CHECK(rolls.spin_up == Approx(3.27 * seen).epsilon(within));
  CHECK(slips.acceleration == Approx(3.63064362).epsilon(within));
  CHECK(slips.spin_up == Approx(2.548713 * seen).epsilon(within));
}

void print_head() {
  std::printf(
      "Wheel on an incline (m/s^2): friction 0.5, a and alpha R | 0.15, a and alpha R\n  %-24s %.4f %.4f | %.4f %.4f\n",
      "exact", 3.27, 3.27, 3.63064362, 2.548713);
}

}  // namespace

TEST_CASE("the accelerations of a wheel on an incline follow from friction and inertia", "[friction][rolling]") {
  CHECK(2 * g * sine / 3 == Approx(3.27).epsilon(1e-9));
  CHECK(g * (sine - 0.15 * cosine) == Approx(3.63064362).epsilon(1e-8));
  CHECK(2 * 0.15 * g * cosine == Approx(2.548713).epsilon(1e-6));
  CHECK(sine / cosine / 3 > 0.15);  // slips
  CHECK(sine / cosine / 3 < 0.5);   // rolls
}

TEST_CASE("a wheel on an incline rolls with two thirds of g sin, or slips", "[friction][rolling]") {
  print_head();
  check_both("flip, 4 a cell and axis", grid("0.05", "4"), 0.025);
}

TEST_CASE("a wheel of finer particles rolls more exactly", "[friction][rolling][slow]") {
  print_head();
  check_both("flip, 2 a cell and axis", grid("0.05", "2"), 0.06);
  std::vector<std::string> apic = grid("0.05", "4");
  apic.push_back(set("/transfer/type", "apic"));
  // The affine velocities hold 2 D omega a mass, h^2 / 2 of R^2 / 2.
  check_both("apic, 4 a cell and axis", apic, 0.025, 1 / (1 + 0.05 * 0.05 / (radius * radius)));
  check_both("flip, half the cells", grid("0.025", "2"), 0.025);
}

TEST_CASE("on a rigid incline a wheel comes to two thirds of g sin with the cells", "[friction][rolling]") {
  const auto error = [](const std::string& cell, const std::string& modulus = "2e6") {
    std::vector<std::string> settings{
        R"J(/bodies=[{"name": "wheel", "material": "m", "particles_per_cell_axis": 4,
          "geometry": {"type": "ball", "centre": [0.7, 0.5], "radius": 0.5}}])J",
        R"J(/rigid_bodies=[{"geometry": {"type": "half_space", "point": [0, 0], "normal": [0, 1]},
          "contact": {"type": "coulomb", "friction": 0.5}}])J",
        "/contact=null", set("/grid/cell_size", cell), set("/materials/m/youngs_modulus", modulus)};
    const double acceleration = roll(settings, 0).acceleration;
    std::printf("Wheel of %s Pa on a rigid incline, cells of %s m: %.4f m/s^2, exact 3.2700\n", modulus.c_str(),
                cell.c_str(), acceleration);
    return 1 - acceleration / 3.27;
  };
  const double coarse = error("0.05"), fine = error("0.025");
  CHECK(coarse < 0.06);
  CHECK((fine > 0 && fine < 0.03));
  CHECK(fine < 0.65 * coarse);
  CHECK(error("0.05", "2e7") < 0.5 * coarse);
}
