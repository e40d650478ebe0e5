#pragma once
// Affine particle-in-cell: each particle carries the local affine velocity field, so rotation survives the round trip.
// Jiang, Schroeder, Selle, Teran & Stomakhin, ACM Trans. Graph. 34 (2015) 51; angular momentum: Jiang et al., J.
// Comput. Phys. 338 (2017) 137.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Apic {
  struct Parameters {};
  template <int D, class S>
  struct State {
    Mat<D, S> affine_velocity;  ///< C = B D^-1, 1/s
  };

  /// w (b + A d) with b = m v and A = m C, d = node - particle.
  template <int D, class S>
  MPM_HD static void scatter(const Parameters&, S mass, const Vec<D, S>& v, const State<D, S>& state, Vec<D, S>& b,
                             Mat<D, S>& A) {
    for (int i = 0; i < D; ++i) b[i] = mass * v[i];
    for (int k = 0; k < D * D; ++k) A.m[k] = mass * state.affine_velocity.m[k];
  }

  /// v <- sum w v+, C <- sum v+ (x) w D^-1 d.
  template <int D, class S>
  MPM_HD static void gather(const Parameters&, const GatheredMoments<D, S>& moments, scalar_of<S>, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    v = moments.velocity;
    state.affine_velocity = moments.affine;
    advection = moments.velocity;
  }

#if MPM_HOST
  static constexpr unsigned traits =
      MPM_SCATTERS_AFFINE | MPM_GATHERS_AFFINE | MPM_AFFINE_CARRIES_ENERGY | MPM_REPLACES_MOTION;
  static constexpr mpm_state state[] = {
      {"affine_velocity", "1/s", "affine velocity matrix C = B D^-1", MPM_STATE_MATRIX, MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm
