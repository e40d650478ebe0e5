#pragma once
// Fluid-implicit-particle: the particle takes the grid's CHANGE of velocity. Brackbill & Ruppel, J. Comput. Phys. 65
// (1986) 314-343.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Flip {
  struct Parameters {
    double pic_fraction;  ///< 0: FLIP, 1: PIC
  };
  template <int D, class S>
  struct State {};

  template <int D, class S>
  MPM_HD static void scatter(const Parameters&, S mass, const Vec<D, S>& v, const State<D, S>&, Vec<D, S>& b,
                             Mat<D, S>&) {
    for (int i = 0; i < D; ++i) b[i] = mass * v[i];
  }

  /// v <- (1 - a)(v + sum w (v+ - v-)) + a sum w v+; sum w v+ moves the particle.
  template <int D, class S>
  MPM_HD static void gather(const Parameters& p, const GatheredMoments<D, S>& moments, scalar_of<S>, Vec<D, S>& v,
                            State<D, S>&, Vec<D, S>& advection) {
    const scalar_of<S> a = real<S>(p.pic_fraction);
    for (int i = 0; i < D; ++i) {
      const S flip = v[i] + moments.velocity_increment[i];
      v[i] = flip + a * (moments.velocity[i] - flip);
    }
    advection = moments.velocity;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_GATHERS_INCREMENT;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(pic_fraction, "", 0.0, 0.0, 1.0, 0,
                           "share of PIC in the velocity update: 0 is FLIP, 1 is PIC"),
  };
#endif
};

}  // namespace mpm
