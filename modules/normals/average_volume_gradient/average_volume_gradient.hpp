#pragma once
// The normal that two bodies share along the difference of their volume gradients. Nairn, CMES 92 (2013) 271-299.

#include "kernel/direction.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct AverageVolumeGradient {
  struct Parameters {};

  template <int D, class S>
  MPM_HD static void find(const Parameters&, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    for (int i = 0; i < D; ++i) result.normal[i] = pair.volume_gradient_a[i] - pair.volume_gradient_b[i];
    result.found = make_unit(result.normal);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_VOLUME_GRADIENT;
#endif
};

}  // namespace mpm
