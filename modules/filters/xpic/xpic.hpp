#pragma once
// Extended particle-in-cell of order m: removes from the particles' velocities what the grid cannot see and damps
// nothing else as m grows. Hammerquist & Nairn, Comput. Methods Appl. Mech. Engrg. 318 (2017) 724-753, in incremental
// form:
//   v = sum_{j<m} (I - S+S)^j S+ V,   V <- S v + dt S a.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Xpic {
  struct Parameters {
    double order;  ///< m: 1 is PIC; m - 1 passes
  };

  MPM_HD static int iterations(const Parameters& p) { return static_cast<int>(p.order) - 1; }

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
  static constexpr unsigned traits = MPM_FILTERS_BEFORE_FORCES;
  static constexpr mpm_parameter parameters[] = {
      MPM_INTEGER_PARAMETER(order, required, 1, 1000,
                            "order m: 1 is PIC; each further order costs one gather and one scatter"),
  };
#endif
};

}  // namespace mpm
