#pragma once
// A column of 50 m of Hencky elasticity under its own weight, and where it comes to rest.
//
// Hencky elasticity at nu = 0 is that of drucker_prager (tau = 2 mu ln l = E ln l along the column) with a cohesion
// that it never comes near.

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "verification/shipped.hpp"

namespace mpm::test::hencky_column {

constexpr double youngs_modulus = 1e6, density = 80, gravity = 10, height = 50;

inline double exact_stress(double Y) {
  return -density * gravity * (height - Y);
}

/// The root of E ln(l) / l = stress by Newton's method.
inline double stretch_of(double stress) {
  double l = 1;
  for (int k = 0; k < 50; ++k)
    l -= (youngs_modulus * std::log(l) / l - stress) / (youngs_modulus * (1 - std::log(l)) / (l * l));
  return l;
}

/// The height at rest of what began at Y: the integral of the stretch, by Simpson's rule.
inline double exact_height(double Y) {
  constexpr int n = 1000;
  double sum = 0;
  for (int k = 0; k <= n; ++k) sum += (k == 0 || k == n ? 1 : k % 2 == 1 ? 4 : 2) * stretch_of(exact_stress(Y * k / n));
  return sum * Y / n / 3;
}

/// The column. Gravity grows over 20 s, eleven periods 4 L / c.
inline const char* column = R"J({
  "dimension": 2,
  "grid": {"cell_size": 1, "domain": [[0, 0], [1, 60]], "boundaries": {"all": "slip"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "drucker_prager", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 80,
                      "friction_angle": "30 deg", "cohesion": 1e12}},
  "bodies": [{"name": "column", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 50]}}],
  "body_force": [0, "5*cos(pi*t/20) - 5"],
  "solver": {"stress_update": "modified_last", "time_step": "auto", "courant": 0.4, "end_time": 20},
  "output": {"ledger": false}})J";

inline std::vector<std::string> settings(const std::string& shape, const std::string& transfer, double cell) {
  const std::string width = digits(cell), top = digits(std::ceil(height / cell + 1) * cell);
  return {set("/grid/cell_size", width), set("/grid/domain", "[[0, 0], [" + width + ", " + top + "]]"),
          set("/bodies/0/geometry/upper", "[" + width + ", 50]"), set("/shape/type", shape),
          set("/transfer/type", transfer)};
}

struct Settled {
  double stress_error = 0;      ///< sum |sigma_p - sigma| V0 / (g density l0 V)
  std::vector<double> heights;  ///< m, heights of Y = 10, 25, 40, 50
};

inline const std::vector<double> marks{10, 25, 40, 50};

inline Settled settle(const std::string& shape, const std::string& transfer, double cell) {
  Scene scene(column, settings(shape, transfer, cell));
  const std::vector<double> start = scene.body().position;
  scene.run();
  const BodyState end = scene.body();
  const auto& F = end.material_state.at("elastic_deformation_gradient");
  const std::size_t count = start.size() / 2, width = F.size() / count;
  Settled settled;
  std::vector<std::pair<double, double>> line;  // Y and y of the first particle of each row
  for (std::size_t p = 0; p < count; ++p) {
    const double Y = start[2 * p + 1], l = F[width * p + 3];
    settled.stress_error += std::abs(youngs_modulus * std::log(l) / l - exact_stress(Y)) /
                            (gravity * density * height * static_cast<double>(count));
    if (line.empty() || Y > line.back().first) line.emplace_back(Y, end.position[2 * p + 1]);
  }
  for (const double mark : marks) {
    std::size_t k = 1;
    while (k + 1 < line.size() && line[k].first < mark) ++k;
    const auto [Y0, y0] = line[k - 1];
    const auto [Y1, y1] = line[k];
    settled.heights.push_back(y0 + (mark - Y0) / (Y1 - Y0) * (y1 - y0));
  }
  return settled;
}

inline const std::vector<double> grids{5, 2.5, 1.25, 0.625};

/// The stress errors on `cells`; prints them, and the heights on the last.
inline std::vector<double> errors_on(const std::string& shape, const std::vector<double>& cells,
                                     std::vector<double>& heights) {
  std::vector<double> errors;
  for (const double cell : cells) {
    const Settled settled = settle(shape, "flip", cell);
    errors.push_back(settled.stress_error);
    heights = settled.heights;
  }
  print_orders(shape, cells, errors);
  std::printf("  %28s", "");
  for (const double y : heights) std::printf(" %.5f", y);
  std::printf("\n");
  return errors;
}

}  // namespace mpm::test::hencky_column
