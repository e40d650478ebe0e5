#pragma once
// Tent functions: N(d) = 1 - |d|, |d| <= 1 cell. C0: the gradient jumps at cell faces, so crossing particles make
// noise. Sulsky, Chen & Schreyer, Comput. Methods Appl. Mech. Engrg. 118 (1994) 179-196, eq. 12.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Linear {
  static constexpr int width = 2;
  /// The second moment f(1 - f) h^2 is not constant; but w D^-1 d = grad w identically, which is finite everywhere.
  static constexpr double second_moment = 0;

  struct Parameters {};

  /// x in cells; base is the first node; w and g (may be null) are weights and derivatives by x.
  template <class S>
  MPM_HD static void evaluate(const Parameters&, S x, S& base, S* w, S* g) {
    base = floor(x);
    const S f = x - base;
    w[0] = real<S>(1) - f;
    w[1] = f;
    if (g) {
      g[0] = S(real<S>(-1));
      g[1] = S(real<S>(1));
    }
  }

#if MPM_HOST
  static constexpr mpm_second_moment second_moment_kind = MPM_MOMENT_IS_GRADIENT;
  /// Measured: docs/studies/extremes.md, "How long a step". Where the grid's velocity strains, no step is
  /// safe: a particle without neighbours that passes a node is stable to sqrt(2 f (1 - f)), f its place in the cell.
  static constexpr double courant_limits[2][3] = {{0.1, 0.1, 0.55}, {0.1, 0.1, 0.55}};
#endif
};

}  // namespace mpm
