// How far two results lie apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "metrics/metrics.hpp"
#include "support/catch.hpp"

namespace mpm::test {

/// The largest difference of any entry; NaN when one is not a number. Fails the test when the lists have different
/// lengths or none.
inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  REQUIRE(!a.empty());
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = larger(largest, std::abs(a[k] - b[k]));
  return largest;
}

/// The change of angular momentum over its size.
inline double lost_spin(const Totals& start, const Totals& end) {
  double change = 0, size = 0;
  for (int c = 0; c < 3; ++c) {
    change += std::pow(end.angular_momentum[c] - start.angular_momentum[c], 2);
    size += std::pow(start.angular_momentum[c], 2);
  }
  return std::sqrt(change / size);
}

}  // namespace mpm::test
