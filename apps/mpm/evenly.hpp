#pragma once

#include <vector>

namespace mpm::app {

/// `count` numbers, two or more, from the first to the last at equal distances.
inline std::vector<double> evenly(double first, double last, int count) {
  std::vector<double> places;
  for (int k = 0; k < count; ++k) places.push_back(first + (last - first) * k / (count - 1));
  return places;
}

}  // namespace mpm::app
