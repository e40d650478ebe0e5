// Hencky elasticity: a column of 50 m under its own weight, many crossings. Heights that particles come to rest at are
// exact: a stretch l carries the stress E ln(l) / l. `ctest -V` shows the tables. The Neo-Hookean column is in
// compaction.cpp.

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "verification/hencky_column.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::hencky_column;

TEST_CASE("the closed form of the Hencky column", "[column]") {
  CHECK(stretch_of(exact_stress(0)) == Approx(0.96224165).margin(5.1e-9));
  const double expected[] = {9.65834382, 24.28312072, 39.07767479, 49.03799142};
  for (std::size_t k = 0; k < marks.size(); ++k) CHECK(std::abs(exact_height(marks[k]) - expected[k]) < 5.1e-9);
}

TEST_CASE("heights of the Hencky column, and stress errors over four grids", "[column]") {
  std::printf(
      "Column, Hencky, FLIP: stress error on cells of 5, 2.5, 1.25, 0.625 m, orders; heights on the last, exact\n  "
      "%28s",
      "");
  for (const double mark : marks) std::printf(" %.5f", exact_height(mark));
  std::printf("\n");
  for (const std::string shape :
       {"linear", "gimp", "gimp_contiguous", "b2gimp", "bspline_quadratic", "bspline_cubic", "cpdi"}) {
    std::vector<double> heights;
    const auto errors = errors_on(shape, grids, heights);
    INFO(shape);
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
