#pragma once
// The end of a cantilever's middle line, found from the four particles beside it in its last two columns.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support/larger.hpp"

namespace mpm::test {

struct BeamEnd {
  std::array<double, 2> tip;  ///< m, on the axes of the grid
  std::array<double, 2> way;  ///< m, from the last column but one to the last
};

/// From the places X at the start and x now, [particle][2], of a beam that began along x and ended at X = length.
inline BeamEnd end_of_beam(const std::vector<double>& X, const std::vector<double>& x, double length) {
  double last = 0, next = 0;
  for (std::size_t p = 0; p < X.size(); p += 2) last = larger(last, X[p]);
  for (std::size_t p = 0; p < X.size(); p += 2)
    if (X[p] < last - 1e-9) next = larger(next, X[p]);
  double sum[2][2] = {}, count[2] = {};
  for (std::size_t p = 0; p < X.size(); p += 2) {
    const int column = X[p] > last - 1e-9 ? 0 : X[p] > next - 1e-9 ? 1 : 2;
    if (column == 2) continue;
    for (std::size_t c = 0; c < 2; ++c) sum[column][c] += x[p + c];
    count[column] += 1;
  }
  const double far = (length - last) / (last - next);
  BeamEnd end{};
  for (std::size_t c = 0; c < 2; ++c) {
    end.tip[c] = (1 + far) * sum[0][c] / count[0] - far * sum[1][c] / count[1];
    end.way[c] = sum[0][c] / count[0] - sum[1][c] / count[1];
  }
  return end;
}

}  // namespace mpm::test
