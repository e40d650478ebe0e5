#pragma once
// The gap between the outermost particles of both bodies, each as the ellipse that its deformed domain holds. Nairn,
// Hammerquist & Smith, CMAME 362 (2020) 112859, take the particles' radii in this way.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct ParticleSurfaces {
  struct Parameters {};

  /// The gap in cells. Bodies that are seeded face to face touch, in float too.
  template <class S>
  MPM_HD static S gap(const Parameters&, const DetectionPair<S>& pair) {
    return pair.surface_b - pair.surface_a - S(real<S>(1e-6));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_PARTICLE_SURFACES;
#endif
};

}  // namespace mpm
