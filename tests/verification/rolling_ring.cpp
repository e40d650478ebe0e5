// A ring on an incline of 30 degrees, from rest: without slipping it rolls with g sin / (1 + I / (m R^2)), where
// I / (m R^2) = (1 + (r / R)^2) / 2 for the radii r < R, from 1/2 for a solid wheel to 1 for a thin ring.

#include <cmath>

#include "support/catch.hpp"
#include "verification/rolling_wheel.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::rolling_wheel;

TEST_CASE("a ring on an incline rolls slower than a solid wheel, by its inertia", "[friction][rolling]") {
  std::printf("Ring on an incline (m/s^2): a and alpha R, exact\n");
  for (const double inner : {0.25, 0.35}) {
    std::vector<std::string> settings = grid("0.05", "4");
    settings.push_back(R"(/bodies/1/geometry={"type": "ring", "centre": [0.7, 0.5], "inner_radius": )" + digits(inner) +
                       R"(, "outer_radius": 0.5})");
    settings.push_back(set("/materials/m/youngs_modulus", "4e6"));
    const double inertia = 0.5 * (1 + inner * inner / (radius * radius)), exact = g * sine / (1 + inertia);
    const Rolling found = roll(settings);
    const double spin_up = found.spin_up * 0.5 / inertia;  // `speeds` has the inertia of a solid cylinder
    std::printf("  inner radius %.2f of 0.5 m: %.4f %.4f, %.4f\n", inner, found.acceleration, spin_up, exact);
    INFO(inner);
    const double within = inner < 0.3 ? 0.025 : 0.035;  // a wall of three cells bends as it rolls
    CHECK(found.acceleration == Approx(exact).epsilon(within));
    CHECK(spin_up == Approx(exact).epsilon(within));
  }
}
