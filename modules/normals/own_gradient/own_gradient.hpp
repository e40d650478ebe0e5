#pragma once
// A normal of its own for each body of a pair, along its volume gradient. Bardenhagen, Brackbill & Sulsky, Comput. Methods
// Appl. Mech. Engrg. 187 (2000) 529-541, take mass gradients, which have the same direction in a body of one density.

#include "kernel/direction.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct OwnGradient {
  struct Parameters {};

  /// The separation is told along the mean of both.
  template <int D, class S>
  MPM_HD static void find(const Parameters&, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    const scalar_of<S> zero = 0;
    for (int i = 0; i < D; ++i)
      result.own_a[i] = pair.volume_gradient_a[i], result.own_b[i] = zero - pair.volume_gradient_b[i];
    const S found_a = make_unit(result.own_a), found_b = make_unit(result.own_b);
    for (int i = 0; i < D; ++i) result.normal[i] = result.own_a[i] + result.own_b[i];
    result.found = found_a * found_b * make_unit(result.normal);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_VOLUME_GRADIENT | MPM_OWN_NORMALS;
#endif
};

}  // namespace mpm
