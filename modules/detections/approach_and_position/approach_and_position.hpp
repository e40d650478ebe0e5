#pragma once
// The gap between the faces whose rows of particles would have the bodies' mean positions. The host inverts the mean
// for the scene's shape function and particles a cell (simulation/contact_detection.hpp).

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct ApproachAndPosition {
  struct Parameters {};

  /// The gap in cells.
  template <class S>
  MPM_HD static S gap(const Parameters&, const DetectionPair<S>& pair) {
    return pair.edge_b - pair.edge_a;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_EDGES;
#endif
};

}  // namespace mpm
