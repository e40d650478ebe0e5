#pragma once
// Which particles a node sees where bodies meet, and what they are there: one rule for all backends
// (simulation/contact_points.hpp, backends/device/kernels/contact_points.hpp). Places are in cells.

#include "kernel/math.hpp"

namespace mpm {

/// A node sees particles so many cells away at least: two rows of particles and more of each body, also with tents.
inline constexpr double least_reach = 1.5;

/// The first and the last node along an axis that see a particle at x from less than `reach` away.
MPM_HD int first_that_sees(double x, double reach) {
  return static_cast<int>(floor(x - reach)) + 1;
}
MPM_HD int last_that_sees(double x, double reach) {
  return -static_cast<int>(floor(-(x + reach))) - 1;
}

/// The weight of the quadratic B-spline along an axis, `x` from its node: what a particle counts in a regression.
MPM_HD double quadratic_weight(double x) {
  const double distance = abs(x), left = 1.5 - min(distance, 1.5);
  return distance < 0.5 ? 0.75 - distance * distance : 0.5 * left * left;
}

/// Half of what a particle, an ellipsoid with these semi-sides as conjugate radii, extends along a unit normal.
/// `semi_sides` are rows of three, whose columns are the vectors.
MPM_HD double extent_along(const double* semi_sides, const double* normal, int dimension) {
  double squared = 0;
  for (int k = 0; k < dimension; ++k) {
    double along = 0;
    for (int i = 0; i < dimension; ++i) along += normal[i] * semi_sides[3 * i + k];
    squared += along * along;
  }
  return sqrt(squared);
}

}  // namespace mpm
