#pragma once
// The normal of the plane that fits the labels -1 and +1 of two bodies' particles near a node best: least squares with a
// penalty on the slope. Nairn, Hammerquist & Smith, Comput. Methods Appl. Mech. Engrg. 362 (2020) 112859.

#include "kernel/direction.hpp"
#include "kernel/linear_system.hpp"
#if MPM_HOST
#include <cstddef>
#include <cstdint>

#include "plugin/tables.hpp"
#endif

namespace mpm {

struct LinearRegression {
  struct Parameters {
    double penalty;  ///< cells^2, beside the weights of the particles
  };

#if MPM_HOST
  /// Minimizes sum w (c - b - s . x)^2 + penalty s^2 over the slope s, 1/cell, and b: s points to the labels +1, of b.
  template <int D>
  static bool find(const Parameters& p, const mpm_normal_points& points, double* normal) {
    double m[D + 1][D + 1] = {}, rhs[D + 1] = {};
    const auto add = [&](const double* position, const double* weight, std::uint32_t count, std::uint32_t stride,
                         double label) {
      for (std::uint32_t k = 0; k < count; ++k) {
        double row[D + 1];
        for (int i = 0; i < D; ++i) row[i] = position[static_cast<std::size_t>(i) * stride + k];
        row[D] = 1;
        for (int i = 0; i <= D; ++i) {
          rhs[i] += weight[k] * label * row[i];
          for (int j = 0; j <= D; ++j) m[i][j] += weight[k] * row[i] * row[j];
        }
      }
    };
    add(points.position_a, points.weight_a, points.count_a, points.stride_a, -1);
    add(points.position_b, points.weight_b, points.count_b, points.stride_b, 1);
    for (int i = 0; i < D; ++i) m[i][i] += p.penalty;
    // The offset goes first, as its equation has no penalty: elimination then centres the others on their mean.
    double turned[D + 1][D + 1], unknown[D + 1];
    for (int i = 0; i <= D; ++i) {
      unknown[i] = rhs[D - i];
      for (int j = 0; j <= D; ++j) turned[i][j] = m[D - i][D - j];
    }
    if (!solve_symmetric(turned, unknown)) return false;
    Vec<D, double> slope;
    for (int i = 0; i < D; ++i) slope[i] = unknown[D - i];
    if (!(make_unit(slope) > 0)) return false;
    for (int i = 0; i < D; ++i) normal[i] = slope[i];
    return true;
  }

  static constexpr unsigned traits = MPM_LOOKS_AT_POINTS;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(penalty, "", 1e-6, 1e-12, 1.0, 0,
                           "penalty on the squared slope, cells^2: it decides where particles leave a direction open"),
  };
#endif
};

}  // namespace mpm
