// Stress errors of the settling column as docs/studies/convergence.md prints them. The numbers are the program's own, and show
// what has changed; the closed form is held in tests/verification/hencky_column.cpp.

#include "verification/hencky_column.hpp"
#include "support/catch.hpp"
#include "support/page.hpp"

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::hencky_column;

TEST_CASE("stress errors of the Hencky column are those that the page of convergence prints", "[column][docs]") {
  std::printf("Column, Hencky, FLIP: stress error on cells of 1.25, 0.625 m, order; heights on the last\n");
  Page page("docs/studies/convergence.md");
  page.keep_from_to("## Elsewhere in the tests", "They grow with refinement");
  for (const std::string shape :
       {"linear", "gimp", "gimp_contiguous", "b2gimp", "bspline_quadratic", "bspline_cubic", "cpdi"}) {
    std::vector<double> heights;
    const auto errors = errors_on(shape, {1.25, 0.625}, heights);
    INFO(shape);
    const auto printed = page.read("| `" + shape + "` | # % | # |");
    CHECK(100 * errors[1] == printed[0].rounded());
    CHECK(std::log2(errors[0] / errors[1]) == printed[1].rounded());
  }
}
