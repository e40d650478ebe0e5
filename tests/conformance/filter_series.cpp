// The filters' series on Fourier modes, where S+S is a number: one particle in the middle of each cell with tents or
// quadratic splines has S+S = cos^2(theta/2). The residual of order k is (I - S+S)^k.

#include <cmath>

#include "filters/fmpm/fmpm.hpp"
#include "filters/xpic/xpic.hpp"
#include "kernel/lanes.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;

/// What a filter makes of the grid velocity 1 of a mode whose round trip multiplies it by `symbol`; the increments'
/// sizes must not grow, since the symbol lies in [0, 1].
template <class Filter>
double filtered(int order, double symbol) {
  const typename Filter::Parameters p{static_cast<double>(order)};
  Vec<2, double> increment{{1, -2}}, velocity = increment;
  for (int iteration = 1; iteration <= Filter::iterations(p); ++iteration) {
    const double before = std::abs(increment[0]);
    const Vec<2, double> projected{{symbol * increment[0], symbol * increment[1]}};
    Filter::update(p, iteration, projected, increment, velocity);
    CHECK(std::abs(increment[0]) <= before);
  }
  CHECK(velocity[1] == -2 * velocity[0]);
  return velocity[0];
}

}  // namespace

TEMPLATE_TEST_CASE("a filter of order k sums k terms of the Neumann series", "", Xpic, Fmpm) {
  for (int order : {1, 2, 3, 4, 8, 30})
    for (int step = 1; step <= 20; ++step) {
      const double c = std::cos(step * 3.14159265358979323846 / 42), symbol = c * c;
      const double residual = std::pow(1 - symbol, order);
      CHECK(std::abs(filtered<TestType>(order, symbol) - (1 - residual) / symbol) <= 1e-13 * order);
      // A mode that is gathered by S and scattered by S+ keeps all but the residual; the null space (symbol 0) is never
      // seen.
      CHECK(std::abs(symbol * filtered<TestType>(order, symbol) - (1 - residual)) <= 1e-13 * order);
    }
}

TEMPLATE_TEST_CASE("order 1 is PIC: no pass", "", Xpic, Fmpm) {
  CHECK(TestType::iterations({1}) == 0);
  CHECK(TestType::iterations({7}) == 6);
  CHECK(filtered<TestType>(1, 0.3) == 1);
}

TEST_CASE("XPIC filters before the forces, FMPM after them") {
  CHECK((Xpic::traits & MPM_FILTERS_BEFORE_FORCES) != 0);
  CHECK((Fmpm::traits & MPM_FILTERS_BEFORE_FORCES) == 0);
}
