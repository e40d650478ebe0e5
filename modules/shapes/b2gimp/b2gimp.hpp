#pragma once
// B2GIMP: the quadratic B-spline averaged over the particle's undeformed box, half length l <= 1/2 cell: 4 nodes an
// axis, C2. Generalised interpolation (Bardenhagen & Kober, CMES 5 (2004) 477-495) over the grid functions of Steffen,
// Kirby & Berzins, Int. J. Numer. Meth. Engng 76 (2008) 922-948.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct B2Gimp {
  static constexpr int width = 4;

  struct Parameters {};

  /// x and the box's half length l in (0, 1/2] in cells; base is the first node; w and g (may be null) are weights and
  /// derivatives by x.
  template <class S>
  MPM_HD static void evaluate(const Parameters&, S x, S l, S& base, S* w, S* g) {
    const scalar_of<S> half = real<S>(0.5), three = real<S>(3);
    const S one = S(real<S>(1)), zero = S(real<S>(0));
    const S cell = floor(x);
    base = cell - one;
    const S f = x - cell;
    const auto in_order = f < half;  // the nearer node lies below the particle; otherwise all is mirrored
    const S a = min(f, one - f), b = half - a, c = half + a;
    // Where a box lies inside one piece of the spline, the mean of a square is the square of the mean and l^2/3 more.
    // Beyond the middle of the cell the pieces change by a multiple of the square of the overlap. No difference of
    // integrals is formed, which would lose digits for small boxes.
    const S sixth = l * l * real<S>(1.0 / 6), overlap = max(l - b, zero), share = overlap / l;
    const S beyond = share * overlap * overlap * real<S>(1.0 / 12);
    const S near_side = half * b * b + sixth - beyond,
            near_node = real<S>(0.75) - a * a - sixth - sixth + three * beyond,
            far_node = half * c * c + sixth - three * beyond;
    w[0] = select(in_order, near_side, beyond);
    w[1] = select(in_order, near_node, far_node);
    w[2] = select(in_order, far_node, near_node);
    w[3] = select(in_order, beyond, near_side);
    if (g) {
      const S slope = real<S>(0.25) * share * overlap;
      const S near_side_slope = -b - slope, near_node_slope = three * slope - (a + a),
              far_node_slope = c - three * slope;
      g[0] = select(in_order, near_side_slope, -slope);
      g[1] = select(in_order, near_node_slope, -far_node_slope);
      g[2] = select(in_order, far_node_slope, -near_node_slope);
      g[3] = select(in_order, slope, -near_side_slope);
    }
  }

#if MPM_HOST
  static constexpr unsigned needs = MPM_NEEDS_HALF_SIZE;
  static constexpr mpm_second_moment second_moment_kind = MPM_MOMENT_PER_PARTICLE;  ///< 1/4 + l^2/3
  /// Measured: docs/studies/extremes.md, "How long a step".
  static constexpr double courant_limits[2][3] = {{1, 0.65, 1.4}, {0.64, 0.31, 1.4}};
#endif
};

}  // namespace mpm
