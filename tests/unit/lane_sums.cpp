// Sums over the particles of a chunk, whose packs may have lanes beyond the last one.

#include <algorithm>
#include <limits>

#include "backends/cpu/particles/particle_chunks.hpp"
#include "support/catch.hpp"

using namespace mpm;

TEMPLATE_TEST_CASE("a sum over particles has each particle once, and nothing of lanes beyond the last", "", float,
                   double) {
  constexpr int packs = 3, width = Lanes<TestType>::width;
  for (int count = 0; count <= packs * width; ++count) {
    alignas(64) TestType values[packs * width];
    std::fill_n(values, packs * width, std::numeric_limits<TestType>::quiet_NaN());
    double expected = 0;
    for (int p = 0; p < count; ++p) values[p] = static_cast<TestType>(1 + p * p), expected += 1 + p * p;
    INFO(count);
    CHECK(cpu::sum_of_particles<TestType>(count, [&](int p) { return Lanes<TestType>::load(values + p); }) == expected);
  }
}
