#pragma once
// Cubic B-splines: 4 nodes an axis, C2. N = |d|^3/2 - d^2 + 2/3 (|d| <= 1), (2 - |d|)^3 / 6 (|d| <= 2), d in cells.
// Steffen, Kirby & Berzins, Int. J. Numer. Meth. Engng 76 (2008) 922-948.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct BsplineCubic {
  static constexpr int width = 4;
  static constexpr double second_moment = 1.0 / 3;  ///< sum w d^2 / h^2, constant

  struct Parameters {};

  /// x in cells; base is the first node; w and g (may be null) are weights and derivatives by x.
  template <class S>
  MPM_HD static void evaluate(const Parameters&, S x, S& base, S* w, S* g) {
    const scalar_of<S> half = real<S>(0.5), sixth = real<S>(1.0 / 6), two_thirds = real<S>(2.0 / 3);
    const S cell = floor(x);
    base = cell - real<S>(1);
    const S a = x - cell, b = real<S>(1) - a;  // distances to the two nodes of the particle's cell
    const S aa = a * a, bb = b * b;
    w[0] = sixth * bb * b;
    w[1] = (half * a - real<S>(1)) * aa + two_thirds;
    w[2] = (half * b - real<S>(1)) * bb + two_thirds;
    w[3] = sixth * aa * a;
    if (g) {
      g[0] = -half * bb;
      g[1] = (real<S>(1.5) * a - real<S>(2)) * a;
      g[2] = (real<S>(2) - real<S>(1.5) * b) * b;
      g[3] = half * aa;
    }
  }

#if MPM_HOST
  static constexpr mpm_second_moment second_moment_kind = MPM_MOMENT_CONSTANT;
  /// Measured: docs/studies/extremes.md, "How long a step".
  static constexpr double courant_limits[2][3] = {{1.15, 0.8, 1.5}, {0.8, 0.36, 1.5}};
#endif
};

}  // namespace mpm
