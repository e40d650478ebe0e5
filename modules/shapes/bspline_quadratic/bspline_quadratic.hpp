#pragma once
// Quadratic B-splines: 3 nodes an axis, C1. N = 3/4 - d^2 (|d| <= 1/2), (3/2 - |d|)^2 / 2 (|d| <= 3/2), d in cells.
// Steffen, Kirby & Berzins, Int. J. Numer. Meth. Engng 76 (2008) 922-948, eq. 26.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct BsplineQuadratic {
  static constexpr int width = 3;
  static constexpr double second_moment = 0.25;  ///< sum w d^2 / h^2, constant

  struct Parameters {};

  /// x in cells; base is the first node; w and g (may be null) are weights and derivatives by x.
  template <class S>
  MPM_HD static void evaluate(const Parameters&, S x, S& base, S* w, S* g) {
    const scalar_of<S> half = real<S>(0.5);
    base = floor(x - half);
    const S f = x - base;
    const S a = real<S>(1.5) - f, b = f - real<S>(1), c = f - half;
    w[0] = half * a * a;
    w[1] = real<S>(0.75) - b * b;
    w[2] = half * c * c;
    if (g) {
      g[0] = -a;
      g[1] = real<S>(-2) * b;
      g[2] = c;
    }
  }

#if MPM_HOST
  static constexpr mpm_second_moment second_moment_kind = MPM_MOMENT_CONSTANT;
  /// Measured: docs/studies/extremes.md, "How long a step".
  static constexpr double courant_limits[2][3] = {{0.9, 0.58, 1.4}, {0.64, 0.31, 1.4}};
#endif
};

}  // namespace mpm
