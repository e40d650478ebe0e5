#pragma once
// Rigid particle-in-cell: PIC that keeps the spin around a particle, so angular momentum survives and shear is damped.
// Jiang, Schroeder, Selle, Teran & Stomakhin (2015), ACM Trans. Graph. 34(4):51, with d = node - particle:
//   to the grid    w m (v + W d)
//   from the grid  v <- sum w v+,   W <- (C - C^T) / 2,   C = sum v+ (x) w D^-1 d

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MyPlugin {
  struct Parameters {};
  template <int D, class S>
  struct State {
    Mat<D, S> spin;  ///< W, antisymmetric, 1/s
  };

  /// A node is given w (b + A d).
  template <int D, class S>
  MPM_HD static void scatter(const Parameters&, S mass, const Vec<D, S>& v, const State<D, S>& state, Vec<D, S>& b,
                             Mat<D, S>& A) {
    for (int i = 0; i < D; ++i) b[i] = mass * v[i];
    for (int k = 0; k < D * D; ++k) A.m[k] = mass * state.spin.m[k];
  }

  /// Takes back from the nodes. v: the particle's velocity before and after; advection: the velocity that moves it. dt
  /// in s.
  template <int D, class S>
  MPM_HD static void gather(const Parameters&, const GatheredMoments<D, S>& moments, scalar_of<S>, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    v = moments.velocity;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) state.spin(i, j) = real<S>(0.5) * (moments.affine(i, j) - moments.affine(j, i));
    advection = moments.velocity;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_SCATTERS_AFFINE | MPM_GATHERS_AFFINE;
  static constexpr mpm_state state[] = {
      {"spin", "1/s", "antisymmetric part of the affine velocity around the particle", MPM_STATE_MATRIX,
       MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm
