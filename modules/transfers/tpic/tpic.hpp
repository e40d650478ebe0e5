#pragma once
// Taylor particle-in-cell: the particle gives nodes the first-order Taylor expansion of its velocity and takes back the
// gradient of the grid's field. Nakamura, Matsumura & Mizutani, Comput. Methods Appl. Mech. Engrg. 403 (2023) 115720.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Tpic {
  struct Parameters {};
  template <int D, class S>
  struct State {
    Mat<D, S> velocity_gradient;  ///< L, 1/s
  };

  /// w (b + A d) with b = m v and A = m L, d = node - particle.
  template <int D, class S>
  MPM_HD static void scatter(const Parameters&, S mass, const Vec<D, S>& v, const State<D, S>& state, Vec<D, S>& b,
                             Mat<D, S>& A) {
    for (int i = 0; i < D; ++i) b[i] = mass * v[i];
    for (int k = 0; k < D * D; ++k) A.m[k] = mass * state.velocity_gradient.m[k];
  }

  /// v <- sum w v+, L <- sum v+ (x) grad w.
  template <int D, class S>
  MPM_HD static void gather(const Parameters&, const GatheredMoments<D, S>& moments, scalar_of<S>, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    v = moments.velocity;
    state.velocity_gradient = moments.velocity_gradient;
    advection = moments.velocity;
  }

#if MPM_HOST
  static constexpr unsigned traits =
      MPM_SCATTERS_AFFINE | MPM_GATHERS_GRADIENT | MPM_AFFINE_CARRIES_ENERGY | MPM_REPLACES_MOTION;
  static constexpr mpm_state state[] = {
      {"velocity_gradient", "1/s", "velocity gradient L of the grid at the particle", MPM_STATE_MATRIX,
       MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm
