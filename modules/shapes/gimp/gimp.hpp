#pragma once
// uGIMP: the tent averaged over the particle's undeformed box, half length l <= 1/2 cell: 3 nodes an axis, C1.
// Bardenhagen & Kober, CMES 5 (2004) 477-495, eqs. 39-40; d = particle - node in cells:
//   w = 1 - (d^2 + l^2)/(2 l)  (|d| < l),   1 - |d|  (l <= |d| <= 1 - l),   (1 + l - |d|)^2/(4 l)  (to 1 + l).

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Gimp {
  static constexpr int width = 3;

  struct Parameters {};

  /// The weight of a side node at distance a in [1/2, 3/2] and minus its slope by a, all three pieces at once. `raw` =
  /// 1 + l - a is the overlap of the box with the tent.
  template <class S>
  MPM_HD static S side(S raw, S l, S& slope) {
    const S full = l + l, overlap = min(max(raw, S(real<S>(0))), full);
    slope = overlap / full;
    return real<S>(0.5) * overlap * slope + (max(raw, full) - full);
  }

  /// x and the box's half length l in (0, 1/2] in cells; base is the first node; w and g (may be null) are weights and
  /// derivatives by x.
  template <class S>
  MPM_HD static void evaluate(const Parameters&, S x, S l, S& base, S* w, S* g) {
    base = floor(x - real<S>(0.5));
    const S d = (x - base) - real<S>(1);  // from the middle node, in [-1/2, 1/2)
    const S distance = abs(d), inside = min(distance, l);
    S before, after;
    w[0] = side(l - d, l, before);
    w[1] = real<S>(1) - (real<S>(0.5) * (inside * inside / l + l) + (distance - inside));
    w[2] = side(l + d, l, after);
    if (g) {
      g[0] = -before;
      g[1] = -(min(max(d, -l), l) / l);
      g[2] = after;
    }
  }

#if MPM_HOST
  static constexpr unsigned needs = MPM_NEEDS_HALF_SIZE;
  static constexpr mpm_second_moment second_moment_kind = MPM_MOMENT_PER_PARTICLE;
  /// Measured: docs/studies/extremes.md, "How long a step".
  static constexpr double courant_limits[2][3] = {{0.575, 0.42, 1}, {0.46, 0.34, 1}};
#endif
};

}  // namespace mpm
