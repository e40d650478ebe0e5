#pragma once
// Polynomial particle-in-cell: APIC whose particles also carry polynomials beyond the affine ones, so that less of the
// grid's velocity is lost in a round trip. Fu, Guo, Gast, Jiang & Teran, ACM Trans. Graph. 36 (2017) 222. Orders 0 and
// 1 are here and equal APIC's; the host carries the others (kernel/polynomial_basis.hpp).

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Polypic {
  struct Parameters {
    double basis;
  };
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
  /// Highest power along an axis; the host takes no more than the shape's nodes bear.
  static int basis_order(const Parameters& p) {
    return p.basis == 0 ? 1 : 3;
  }

  static constexpr unsigned traits =
      MPM_SCATTERS_AFFINE | MPM_GATHERS_AFFINE | MPM_AFFINE_CARRIES_ENERGY | MPM_REPLACES_MOTION;
  static constexpr mpm_parameter parameters[] = {
      MPM_CHOICE_PARAMETER(basis, "multilinear|full", 0,
                           "multilinear: products of powers up to 1 along each axis; full: as many powers as the shape "
                           "has nodes along an axis"),
  };
  static constexpr mpm_state state[] = {
      {"affine_velocity", "1/s", "affine velocity matrix C = B D^-1", MPM_STATE_MATRIX, MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm
