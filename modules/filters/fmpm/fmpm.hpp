#pragma once
// Full-mass-matrix MPM of order k: v+ times the truncated Neumann series of the inverse consistent mass matrix.
// Nairn & Hammerquist, Comput. Methods Appl. Mech. Engrg. 377 (2021) 113667; the loop in increments: Nairn, arXiv
// 2604.07307 (2026):   v = sum_{j<k} (I - S+S)^j v+,   residual (I - S+S)^k v.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Fmpm {
  struct Parameters {
    double order;  ///< k: 1 is PIC; k - 1 passes
  };

  MPM_HD static int iterations(const Parameters& p) { return static_cast<int>(p.order) - 1; }

  /// The filtered step is stable up to 1 / sqrt(k) of the unfiltered one (Nairn 2026, arXiv 2604.07307): modes that the
  /// grid hardly sees are multiplied by up to k, and their stiffness with them.
  MPM_HD static double step_limit(const Parameters& p, double unfiltered) {
    return unfiltered / sqrt(1.0 + iterations(p));
  }

  /// v* <- v* - S+S v*; v <- v + v*.
  template <int D, class S>
  MPM_HD static void update(const Parameters&, int, const Vec<D, S>& projected, Vec<D, S>& increment,
                            Vec<D, S>& velocity) {
    for (int i = 0; i < D; ++i) {
      increment[i] = increment[i] - projected[i];
      velocity[i] = velocity[i] + increment[i];
    }
  }

#if MPM_HOST
  static constexpr unsigned traits = 0;
  static constexpr mpm_parameter parameters[] = {
      MPM_INTEGER_PARAMETER(order, required, 1, 1000,
                            "order k: 1 is PIC; each further order costs one gather and one scatter"),
  };
#endif
};

}  // namespace mpm
