#pragma once
// An imperfect interface that resists compression otherwise than tension. Nairn, CMES 92 (2013) 271-299.

#include "kernel/springs.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct BilinearInterface {
  struct Parameters {
    double tension_stiffness;      ///< traction per opening, Pa/m
    double compression_stiffness;  ///< pressure per closing, Pa/m
    double shear_stiffness;        ///< traction per slip, Pa/m
  };

  /// The stiffness is that of the opening in the middle of the step.
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const RelativeMotion<D, S> motion(pair);
    const scalar_of<S> zero = 0;
    S opening = real<S>(-0.5) * pair.dt * motion.approach;
    for (int i = 0; i < D; ++i) opening = opening + pair.displacement[i] * pair.normal[i];
    const S normal_stiffness =
        select(opening > zero, S(real<S>(p.tension_stiffness)), S(real<S>(p.compression_stiffness)));
    pull(pair, motion, normal_stiffness, S(real<S>(p.shear_stiffness)), result);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_PULLS | MPM_COMPLIANT | MPM_ACTS_OVER_TIME;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(tension_stiffness, "Pa/m", required, 0.0, unbounded, 0,
                           "traction per distance by which the bodies have moved apart"),
      MPM_NUMBER_PARAMETER(compression_stiffness, "Pa/m", required, 0.0, unbounded, 0,
                           "pressure per distance by which they have moved into one another"),
      MPM_NUMBER_PARAMETER(shear_stiffness, "Pa/m", required, 0.0, unbounded, 0,
                           "traction across the normal per distance by which one has slid along the other"),
  };
#endif
};

}  // namespace mpm
