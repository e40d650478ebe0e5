#pragma once
// Affine FLIP: the velocity update of FLIP beside the affine velocity field of APIC. Fei, Guo, Wu, Huang & Gao, ACM
// Trans. Graph. 40 (2021) 109, with alpha = 1 - pic_fraction.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Aflip {
  struct Parameters {
    double pic_fraction;  ///< 1 - alpha; 1: APIC
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

  /// v <- sum w v+ + alpha (v - sum w v-), C <- sum v+ (x) w D^-1 d; sum w v+ moves the particle.
  template <int D, class S>
  MPM_HD static void gather(const Parameters& p, const GatheredMoments<D, S>& moments, scalar_of<S>, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    const scalar_of<S> a = real<S>(p.pic_fraction);
    for (int i = 0; i < D; ++i) {
      const S flip = v[i] + moments.velocity_increment[i];
      v[i] = flip + a * (moments.velocity[i] - flip);
    }
    state.affine_velocity = moments.affine;
    advection = moments.velocity;
  }

#if MPM_HOST
  static constexpr unsigned traits =
      MPM_SCATTERS_AFFINE | MPM_GATHERS_AFFINE | MPM_GATHERS_INCREMENT | MPM_STARTS_WITH_GRADIENT;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(pic_fraction, "", 0.01, 0.0, 1.0, 0,
                           "share of APIC in the velocity update: 0 keeps the particle's own velocity, 1 is APIC"),
  };
  static constexpr mpm_state state[] = {
      {"affine_velocity", "1/s", "affine velocity matrix C = B D^-1", MPM_STATE_MATRIX, MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm
