#pragma once
// cpGIMP: the tent averaged over a box that follows the particle's deformation along the axes, half length l of up to a
// whole cell: 4 nodes an axis, C1. Bardenhagen & Kober, CMES 5 (2004) 477-495; boxes by diag F and by diag U: Charlton,
// Coombs & Augarde, Computers & Structures 190 (2017) 108-125.
//   w = N(d) + e(d + 1) - 2 e(d) + e(d - 1),   e(s) = max(0, l - |s|)^2/(4 l),   N the tent, d = particle - node in
//   cells.

#include "kernel/functor.hpp"
#include "kernel/polar.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct GimpContiguous {
  static constexpr int width = 4;

  struct Parameters {
    double stretch_by;  ///< 0: diag F, 1: diag U
  };

  /// Half lengths of the box in cells, from the semi-side vectors of a domain that was a cube: domain = F l0.
  template <int D, class S>
  MPM_HD static Vec<D, S> half_lengths(const Parameters& p, const Mat<D, S>& domain) {
    Vec<D, S> l;
    for (int a = 0; a < D; ++a) l[a] = abs(domain(a, a));
    if constexpr (D > 1)
      if (p.stretch_by > 0.5) {
        const Mat<D, S> R = nearest_rotation(domain);
        for (int a = 0; a < D; ++a) {  // U = R^T F
          l[a] = R(0, a) * domain(0, a);
          for (int k = 1; k < D; ++k) l[a] = l[a] + R(k, a) * domain(k, a);
          l[a] = abs(l[a]);
        }
      }
    return l;
  }

  /// x and the box's half length l in cells; base is the first node; w and g (may be null) are weights and derivatives
  /// by x, all zero where l is beyond 1, which 4 nodes do not hold.
  template <class S>
  MPM_HD static void evaluate(const Parameters&, S x, S l, S& base, S* w, S* g) {
    const S one = S(real<S>(1)), zero = S(real<S>(0));
    const S held = select(l <= one, one, zero);
    // A collapsed box is a tent: its slope at a node stays the mean of both sides, and nothing divides by zero.
    const S box = max(l, S(real<S>(0x1p-20))), cell = floor(x);
    base = cell - one;
    const S f = x - cell, rest = one - f;
    const S below = max(box - f, zero), above = max(box - rest, zero);  // reach of the box beyond the cell
    const S share_below = real<S>(0.5) * (below / box), share_above = real<S>(0.5) * (above / box);
    const S e0 = real<S>(0.5) * share_below * below, e1 = real<S>(0.5) * share_above * above;
    w[0] = held * e0;
    w[1] = held * (rest + e1 - (e0 + e0));
    w[2] = held * (f + e0 - (e1 + e1));
    w[3] = held * e1;
    if (g) {
      g[0] = held * -share_below;
      g[1] = held * (share_above + (share_below + share_below) - one);
      g[2] = held * (one - share_below - (share_above + share_above));
      g[3] = held * share_above;
    }
  }

#if MPM_HOST
  static constexpr unsigned needs = MPM_NEEDS_DOMAIN;
  static constexpr mpm_second_moment second_moment_kind = MPM_MOMENT_PER_PARTICLE;
  static constexpr mpm_parameter parameters[] = {
      MPM_CHOICE_PARAMETER(stretch_by, "deformation_gradient|right_stretch", 0,
                           "What stretches the box along an axis: the diagonal of F, or of the stretch U in F = R U."),
  };
  /// Measured: docs/studies/extremes.md, "How long a step".
  static constexpr double courant_limits[2][3] = {{0.575, 0.42, 1}, {0.44, 0.34, 1}};
#endif
};

}  // namespace mpm
