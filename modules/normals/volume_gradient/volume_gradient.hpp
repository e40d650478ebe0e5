#pragma once
// The normal along the volume gradient of one body of a pair, the one that has more of it. Nairn, CMES 92 (2013) 271-299.

#include "kernel/direction.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct VolumeGradient {
  struct Parameters {};

  /// Where both have as much, neither body decides alone: exchanging them only turns the normal.
  template <int D, class S>
  MPM_HD static void find(const Parameters&, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    const scalar_of<S> zero = 0;
    S squared_a(zero), squared_b(zero);
    for (int i = 0; i < D; ++i) {
      squared_a = squared_a + pair.volume_gradient_a[i] * pair.volume_gradient_a[i];
      squared_b = squared_b + pair.volume_gradient_b[i] * pair.volume_gradient_b[i];
    }
    for (int i = 0; i < D; ++i) {
      const S of_a = pair.volume_gradient_a[i], of_b = zero - pair.volume_gradient_b[i];
      result.normal[i] = select(squared_a > squared_b, of_a, select(squared_b > squared_a, of_b, of_a + of_b));
    }
    result.found = make_unit(result.normal);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_VOLUME_GRADIENT;
#endif
};

}  // namespace mpm
