#pragma once
// Particle-in-cell: the particle takes the grid's velocity. Stable and strongly dissipative: one step multiplies a wave
// by |symbol of S|^2. Harlow (1964), Methods Comput. Phys. 3:319-343.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Pic {
  struct Parameters {};
  template <int D, class S>
  struct State {};

  /// What the particle gives a node: w b.
  template <int D, class S>
  MPM_HD static void scatter(const Parameters&, S mass, const Vec<D, S>& v, const State<D, S>&, Vec<D, S>& b,
                             Mat<D, S>&) {
    for (int i = 0; i < D; ++i) b[i] = mass * v[i];
  }

  /// v <- sum w v+; the same velocity moves the particle.
  template <int D, class S>
  MPM_HD static void gather(const Parameters&, const GatheredMoments<D, S>& moments, scalar_of<S>, Vec<D, S>& v,
                            State<D, S>&, Vec<D, S>& advection) {
    v = moments.velocity;
    advection = moments.velocity;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_REPLACES_MOTION;
#endif
};

}  // namespace mpm
