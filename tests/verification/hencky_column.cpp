// Hencky elasticity: a column of 50 m under its own weight, many crossings. Heights that particles come to rest at are
// exact: a stretch l carries the stress E ln(l) / l. `ctest -V` shows the tables. The Neo-Hookean column is in
// compaction.cpp.
//
// Hencky elasticity at nu = 0 is that of drucker_prager (tau = 2 mu ln l = E ln l along the column) with a cohesion
// that it never comes near.

#include <algorithm>
#include <cmath>

#include "shipped.hpp"
#include "support/catch.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double youngs_modulus = 1e6, density = 80, gravity = 10, height = 50;

double exact_stress(double Y) {
  return -density * gravity * (height - Y);
}

/// The root of E ln(l) / l = stress by Newton's method.
double stretch_of(double stress) {
  double l = 1;
  for (int k = 0; k < 50; ++k)
    l -= (youngs_modulus * std::log(l) / l - stress) / (youngs_modulus * (1 - std::log(l)) / (l * l));
  return l;
}

/// The height at rest of what began at Y: the integral of the stretch, by Simpson's rule.
double exact_height(double Y) {
  constexpr int n = 1000;
  double sum = 0;
  for (int k = 0; k <= n; ++k) sum += (k == 0 || k == n ? 1 : k % 2 == 1 ? 4 : 2) * stretch_of(exact_stress(Y * k / n));
  return sum * Y / n / 3;
}

/// The column. Gravity grows over 20 s, eleven periods 4 L / c.
const char* column = R"J({
  "dimension": 2,
  "grid": {"cell_size": 1, "domain": [[0, 0], [1, 60]], "boundaries": {"all": "slip"}},
  "shape": {"type": "gimp"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "drucker_prager", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 80,
                      "friction_angle": "30 deg", "cohesion": 1e12}},
  "bodies": [{"name": "column", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 50]}}],
  "body_force": [0, "5*cos(pi*t/20) - 5"],
  "solver": {"stress_update": "modified_last", "time_step": "auto", "courant": 0.4, "end_time": 20},
  "output": {"ledger": false}})J";

std::vector<std::string> settings(const std::string& shape, const std::string& transfer, double cell) {
  const std::string width = digits(cell), top = digits(std::ceil(height / cell + 1) * cell);
  return {set("/grid/cell_size", width), set("/grid/domain", "[[0, 0], [" + width + ", " + top + "]]"),
          set("/bodies/0/geometry/upper", "[" + width + ", 50]"), set("/shape/type", shape),
          set("/transfer/type", transfer)};
}

struct Settled {
  double stress_error = 0;      ///< sum |sigma_p - sigma| V0 / (g density l0 V)
  std::vector<double> heights;  ///< m, heights of Y = 10, 25, 40, 50
};

const std::vector<double> marks{10, 25, 40, 50};

Settled settle(const std::string& shape, const std::string& transfer, double cell) {
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

}  // namespace

TEST_CASE("the closed form of the Hencky column", "[column]") {
  CHECK(stretch_of(exact_stress(0)) == Approx(0.96224165).margin(5.1e-9));
  const double expected[] = {9.65834382, 24.28312072, 39.07767479, 49.03799142};
  for (std::size_t k = 0; k < marks.size(); ++k) CHECK(std::abs(exact_height(marks[k]) - expected[k]) < 5.1e-9);
}

namespace {

const std::vector<double> grids{5, 2.5, 1.25, 0.625};

/// The stress errors on `cells`; prints them, and the heights on the last.
std::vector<double> errors_on(const std::string& shape, const std::vector<double>& cells,
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

}  // namespace

TEST_CASE("heights of the Hencky column, and stress errors over four grids", "[column]") {
  std::printf(
      "Column, Hencky, FLIP: stress error on cells of 5, 2.5, 1.25, 0.625 m, orders; heights on the last, exact\n  "
      "%28s",
      "");
  for (const double mark : marks) std::printf(" %.5f", exact_height(mark));
  std::printf("\n");
  Page page("docs/studies/convergence.md");
  page.keep_from_to("## Elsewhere in the tests", "They grow with refinement");
  for (const std::string shape :
       {"linear", "gimp", "gimp_contiguous", "b2gimp", "bspline_quadratic", "bspline_cubic", "cpdi"}) {
    std::vector<double> heights;
    const auto errors = errors_on(shape, grids, heights);
    INFO(shape);
    const auto printed = page.read("| `" + shape + "` | # % | # |");
    CHECK(100 * errors.back() == printed[0].rounded());
    CHECK(std::log2(errors[grids.size() - 2] / errors.back()) == printed[1].rounded());
    if (shape == "linear") {
      // Errors grow with refinement: the finer the cells, the more of them are crossed.
      for (std::size_t k = 1; k < grids.size(); ++k) CHECK(errors[k] > errors[k - 1]);
      continue;
    }
    const bool is_stretching = shape == "gimp_contiguous" || shape == "cpdi",
               has_box = is_stretching || shape == "gimp";
    // Splines weigh particles without their size: rows of them do not sum evenly over a node, and the stress ripples.
    for (std::size_t k = 0; k < marks.size(); ++k)
      CHECK(std::abs(heights[k] - exact_height(marks[k])) < (has_box ? 2e-4 : 0.01));
    for (std::size_t k = 1; k < grids.size(); ++k) CHECK(errors[k] < (has_box ? 0.5 : 0.9) * errors[k - 1]);
    if (is_stretching) CHECK(observed_order(grids, errors) > 1.7);
    if (!has_box) CHECK(observed_order(grids, errors) < 0.6);
  }
}

TEST_CASE("on a finer grid boxes that do not shorten with the column stall too", "[column][slow]") {
  std::printf("Column, Hencky, FLIP: stress error on cells of 0.625, 0.3125 m, order; heights on the last\n");
  const std::vector<double> fine{0.625, 0.3125};
  std::vector<double> heights;
  for (const std::string shape : {"gimp_contiguous", "cpdi"})
    CHECK(observed_order(fine, errors_on(shape, fine, heights)) > 1.6);
  for (const std::string shape : {"gimp", "bspline_quadratic", "bspline_cubic", "linear"})
    CHECK(observed_order(fine, errors_on(shape, fine, heights)) < 0.5);
}
