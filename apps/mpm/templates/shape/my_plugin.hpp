#pragma once
// Quadratic B-splines, 3 nodes an axis, C1; d in cells between node and particle (Steffen, Kirby & Berzins 2008, Int.
// J. Numer. Meth. Engng 76:922-948, eq. 26):
//   N(d) = 3/4 - d^2 for |d| <= 1/2,   (3/2 - |d|)^2 / 2 for |d| <= 3/2,   sum w = 1,   sum w d = 0,   sum w d^2 = 1/4

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MyPlugin {
  static constexpr int width = 3;                ///< nodes an axis, 2 to 4
  static constexpr double second_moment = 0.25;  ///< sum w d^2 in cells^2, the same everywhere
  struct Parameters {};

  /// Weights of one axis. x: the particle's place in cells; base: the first of its nodes; w: weights; g: their
  /// derivatives by x, null when nobody asked.
  template <class S>
  MPM_HD static void evaluate(const Parameters&, S x, S& base, S* w, S* g) {
    const scalar_of<S> half = real<S>(0.5);
    base = floor(x - half);
    const S f = x - base;  // lies in 1/2 to 3/2
    const S a = real<S>(1.5) - f, b = f - real<S>(1), c = f - half;
    w[0] = half * a * a;
    w[1] = real<S>(0.75) - b * b;
    w[2] = half * c * c;
    if (!g) return;
    g[0] = -a;
    g[1] = real<S>(-2) * b;
    g[2] = c;
  }

#if MPM_HOST
  static constexpr mpm_second_moment second_moment_kind = MPM_MOMENT_CONSTANT;
#endif
};

}  // namespace mpm
