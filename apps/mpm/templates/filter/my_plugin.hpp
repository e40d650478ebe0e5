#pragma once
// FMPM of order m (Nairn & Hammerquist 2021, Comput. Methods Appl. Mech. Engrg. 377:113667): the inverse of the full
// mass matrix by its series of m terms, with S the map from grid to particles and S+ the mass-weighted map back:
//   v <- sum_{k < m} (I - S+ S)^k v,   built one term a pass:  increment <- increment - S+ S increment,
//                                                               v <- v + increment
// Order 1 changes nothing. High orders keep all that the particles can represent and drop the noise they cannot.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MyPlugin {
  struct Parameters {
    double order;
  };

  /// Passes of the loop: the first term is the velocity itself.
  MPM_HD static int iterations(const Parameters& p) { return static_cast<int>(p.order) - 1; }

  /// The longest stable step with the filter, s: what the grid hardly sees is multiplied by up to m.
  static double step_limit(const Parameters& p, double unfiltered) { return unfiltered / sqrt(p.order); }

  /// Changes one node in one pass (iteration counts from 1). projected = S+ S increment, m/s.
  template <int D, class S>
  MPM_HD static void update(const Parameters&, int, const Vec<D, S>& projected, Vec<D, S>& increment,
                            Vec<D, S>& velocity) {
    for (int i = 0; i < D; ++i) {
      increment[i] = increment[i] - projected[i];
      velocity[i] = velocity[i] + increment[i];
    }
  }

#if MPM_HOST
  static constexpr unsigned traits = 0;  ///< no trait: it filters the velocity after the forces
  static constexpr mpm_parameter parameters[] = {
      MPM_INTEGER_PARAMETER(order, 4, 1, 100, "terms of the series; 1 is the unfiltered velocity"),
  };
#endif
};

}  // namespace mpm
