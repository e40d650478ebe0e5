#pragma once
// Affine separable FLIP: AFLIP whose particles also move with a share of the velocity that the grid smooths away, so
// that neighbours which share nodes can part. Fei, Guo, Wu, Huang & Gao, ACM Trans. Graph. 40 (2021) 109: x += dt (sum
// w v+ + beta alpha (v - sum w v-)), beta = beta_max where the particle's surroundings open, else beta_min.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Asflip {
  struct Parameters {
    double pic_fraction;  ///< 1 - alpha
    double beta_min;      ///< share in the movement where material is pressed together
    double beta_max;      ///< share in the movement where it is not
    double threshold;     ///< value of ln J below which material counts as pressed together
  };
  template <int D, class S>
  struct State {
    Mat<D, S> affine_velocity;  ///< C = B D^-1, 1/s
    S log_volume_ratio;         ///< sum dt tr C: ln J of the motion
  };

  /// w (b + A d) with b = m v and A = m C, d = node - particle.
  template <int D, class S>
  MPM_HD static void scatter(const Parameters&, S mass, const Vec<D, S>& v, const State<D, S>& state, Vec<D, S>& b,
                             Mat<D, S>& A) {
    for (int i = 0; i < D; ++i) b[i] = mass * v[i];
    for (int k = 0; k < D * D; ++k) A.m[k] = mass * state.affine_velocity.m[k];
  }

  /// v <- u + alpha r and the movement by u + beta alpha r with u = sum w v+, r = v - sum w v-; C as APIC.
  template <int D, class S>
  MPM_HD static void gather(const Parameters& p, const GatheredMoments<D, S>& moments, scalar_of<S> dt, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    using T = scalar_of<S>;
    S rate = moments.affine(0, 0);
    for (int i = 1; i < D; ++i) rate = rate + moments.affine(i, i);
    state.affine_velocity = moments.affine;
    state.log_volume_ratio = state.log_volume_ratio + dt * rate;
    const S beta =
        select(state.log_volume_ratio < real<S>(p.threshold), S(real<S>(p.beta_min)), S(real<S>(p.beta_max)));
    const T a = real<S>(p.pic_fraction);
    for (int i = 0; i < D; ++i) {
      const S flip = v[i] + moments.velocity_increment[i];
      v[i] = flip + a * (moments.velocity[i] - flip);
      advection[i] = moments.velocity[i] + beta * (v[i] - moments.velocity[i]);
    }
  }

#if MPM_HOST
  static constexpr unsigned traits =
      MPM_SCATTERS_AFFINE | MPM_GATHERS_AFFINE | MPM_GATHERS_INCREMENT | MPM_STARTS_WITH_GRADIENT;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(pic_fraction, "", 0.01, 0.0, 1.0, 0,
                           "share of APIC in the velocity update: 0 keeps the particle's own velocity, 1 is APIC"),
      MPM_NUMBER_PARAMETER(beta_min, "", 0.0, 0.0, 1.0, 0,
                           "share of the kept velocity that moves a particle whose surroundings are pressed together"),
      MPM_NUMBER_PARAMETER(beta_max, "", 1.0, 0.0, 1.0, 0,
                           "share of the kept velocity that moves any other particle: 0 is AFLIP, 1 separates best"),
      MPM_NUMBER_PARAMETER(threshold, "", -0.001, -1.0, 1.0, 0,
                           "ln J of the motion below which the surroundings count as pressed together"),
  };
  static constexpr mpm_state state[] = {
      {"affine_velocity", "1/s", "affine velocity matrix C = B D^-1", MPM_STATE_MATRIX, MPM_INITIAL_ZERO},
      {"log_volume_ratio", "", "sum of dt tr C: ln J of the motion, for the separation test", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm
