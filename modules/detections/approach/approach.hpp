#pragma once
// Bodies touch wherever they share a node and approach, however far apart their surfaces are. Bardenhagen, Brackbill &
// Sulsky, CMAME 187 (2000) 529-541.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Approach {
  struct Parameters {};

  /// The gap in cells, whatever the pair.
  template <class S>
  MPM_HD static S gap(const Parameters&, const DetectionPair<S>&) {
    return S(real<S>(0));
  }

#if MPM_HOST
  static constexpr unsigned traits = 0;
#endif
};

}  // namespace mpm
