#pragma once
// Rings of a thick tube under inner pressure, whose material hardly changes its volume.

#include <string>
#include <vector>

#include "shipped.hpp"
#include "support/catch.hpp"

namespace mpm::test::locking_tube {

constexpr double a = 0.1, b = 0.2, modulus = 1e6, pressure = 100;

inline double lame(double r, double nu) {
  return (1 + nu) / modulus * pressure * a * a / (b * b - a * a) * ((1 - 2 * nu) * r + b * b / r);
}

struct Tube {
  std::string shape, transfer = "apic";
  double nu = 0.3;
  int cells = 4;  ///< of the wall
  bool averaged = false;
};

/// How much more the inner radius of rings widens than Lame says, over that. The field is fitted as A r + B / r, which it
/// is, to the particles by least squares.
inline double error_of(const Tube& tube, const std::vector<std::string>& more = {}) {
  const std::string h = digits(0.1 / tube.cells);
  std::vector<std::string> overrides{set("/grid/cell_size", h),
                                     "/grid/domain=[[0.05, 0], [0.25, " + h + "]]",
                                     "/bodies/0/geometry/upper=[0.2, " + h + "]",
                                     set("/output/ledger", "false"),
                                     set("/shape/type", tube.shape),
                                     set("/transfer/type", tube.transfer),
                                     set("/materials/rubber/poisson_ratio", digits(tube.nu)),
                                     set("/solver/dilation", tube.averaged ? "averaged" : "own"),
                                     set("/loads/0/pressure", "100*(t/0.1)^3*(10 - 15*t/0.1 + 6*(t/0.1)^2)"),
                                     set("/solver/end_time", "0.1")};
  overrides.insert(overrides.end(), more.begin(), more.end());
  ShippedScene scene("loads/tube.json", overrides);
  const std::vector<double> X = scene.simulation.backend().body_state(0).position;
  scene.run();
  REQUIRE(scene.failure.empty());
  const std::vector<double> x = scene.simulation.backend().body_state(0).position;
  double normal[2][2] = {}, right[2] = {};
  for (std::size_t p = 0; p < X.size(); p += 2) {
    const double of[2] = {X[p], 1 / X[p]};
    for (int i = 0; i < 2; ++i) {
      right[i] += of[i] * (x[p] - X[p]);
      for (int j = 0; j < 2; ++j) normal[i][j] += of[i] * of[j];
    }
  }
  const double determinant = normal[0][0] * normal[1][1] - normal[0][1] * normal[1][0];
  const double A = (right[0] * normal[1][1] - right[1] * normal[0][1]) / determinant,
               B = (right[1] * normal[0][0] - right[0] * normal[1][0]) / determinant;
  return (A * a + B / a) / lame(a, tube.nu) - 1;
}

}  // namespace mpm::test::locking_tube
