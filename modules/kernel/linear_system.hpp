#pragma once
// Small symmetric systems of equations: what fits of planes to points need. Device-safe.

#include "kernel/math.hpp"

namespace mpm {

/// Solves m x = rhs by elimination; `m` is symmetric, positive definite, and lost, and `rhs` becomes x. Returns false
/// where it is singular to rounding.
template <int N>
MPM_HD bool solve_symmetric(double (&m)[N][N], double (&rhs)[N]) {
  double largest = 0;
  for (int i = 0; i < N; ++i) largest = max(largest, m[i][i]);
  for (int k = 0; k < N; ++k) {
    if (!(m[k][k] > 1e-14 * largest)) return false;
    for (int i = k + 1; i < N; ++i) {
      const double factor = m[i][k] / m[k][k];
      for (int j = k; j < N; ++j) m[i][j] -= factor * m[k][j];
      rhs[i] -= factor * rhs[k];
    }
  }
  for (int k = N - 1; k >= 0; --k) {
    for (int j = k + 1; j < N; ++j) rhs[k] -= m[k][j] * rhs[j];
    rhs[k] /= m[k][k];
  }
  return true;
}

}  // namespace mpm
