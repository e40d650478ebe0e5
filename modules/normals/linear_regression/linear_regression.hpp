#pragma once
// The normal of the plane that fits the labels -1 and +1 of two bodies' particles near a node best: least squares with a
// penalty on the slope. Nairn, Hammerquist & Smith, Comput. Methods Appl. Mech. Engrg. 362 (2020) 112859.

#include "kernel/direction.hpp"
#include "kernel/linear_system.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct LinearRegression {
  struct Parameters {
    double penalty;  ///< cells^2, beside the weights of the particles
  };

  /// What a particle adds to the matrix, row by row up to the diagonal: the last row is that of the offset.
  template <int D>
  struct Terms {
    static constexpr int rows = D + 1, count = rows * (rows + 1) / 2;

    template <class S>
    MPM_HD void operator()(const Vec<3, S>& place, const S& weight, S* values) const {
      for (int i = 0; i < rows; ++i) {
        const S along = i < D ? weight * place[i] : weight;
        for (int j = 0; j <= i; ++j) *values++ = j < D ? along * place[j] : along;
      }
    }
  };
  /// Adds one body's particles to the equations of slope and offset, whose right side is the last row times the labels.
  template <int D, class Cloud>
  MPM_HD static void add(const Cloud& cloud, double label, double (&m)[D + 1][D + 1], double (&rhs)[D + 1]) {
    double values[Terms<D>::count] = {};
    cloud.add(Terms<D>(), values);
    const double* value = values;
    for (int i = 0; i <= D; ++i)
      for (int j = 0; j <= i; ++j, ++value) {
        m[i][j] += *value;
        if (i != j) m[j][i] += *value;
        if (i == D) rhs[j] += label * *value;
      }
  }

  /// Minimizes sum w (c - b - s . x)^2 + penalty s^2 over the slope s, 1/cell, and b: s points to the labels +1, of b. There
  /// is no normal where one body's particles have no weight, or the slope is what rounding makes of labels that follow no
  /// direction.
  template <int D, class Points>
  MPM_HD static bool find(const Parameters& p, const Points& points, double* normal) {
    double m[D + 1][D + 1] = {}, rhs[D + 1] = {};
    add<D>(points.a, -1, m, rhs);
    add<D>(points.b, 1, m, rhs);
    // Of one body alone the slope is 0 to rounding, which a small penalty divides.
    if (!(abs(rhs[D]) < m[D][D])) return false;
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
    constexpr double least_slope = 1e-9;  // rounding makes no more of labels that follow no direction
    double square = 0;
    for (int i = 0; i < D; ++i) square += slope[i] * slope[i];
    if (!(square > least_slope * least_slope) || !(make_unit(slope) > 0)) return false;
    for (int i = 0; i < D; ++i) normal[i] = slope[i];
    return true;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_LOOKS_AT_POINTS;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(penalty, "", 1e-6, 1e-12, 1.0, 0,
                           "penalty on the squared slope, cells^2: it decides where particles leave a direction open"),
  };
#endif
};

}  // namespace mpm
