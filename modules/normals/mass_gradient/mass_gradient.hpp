#pragma once
// The normal that two bodies share along the difference of their mass gradients. Bardenhagen, Brackbill & Sulsky, Comput.
// Methods Appl. Mech. Engrg. 187 (2000) 529-541.

#include "kernel/direction.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MassGradient {
  struct Parameters {};

  template <int D, class S>
  MPM_HD static void find(const Parameters&, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    for (int i = 0; i < D; ++i) result.normal[i] = pair.mass_gradient_a[i] - pair.mass_gradient_b[i];
    result.found = make_unit(result.normal);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_MASS_GRADIENT;
#endif
};

}  // namespace mpm
