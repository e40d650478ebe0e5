#pragma once
// An imperfect interface: bodies are joined by a layer without thickness whose traction is linear in how far they have
// moved beside one another since the start. Hashin, J. Mech. Phys. Solids 39 (1991) 745-762; in MPM Nairn, Comput. Mater.
// Sci. 40 (2007) 525-536.

#include "kernel/springs.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct LinearInterface {
  struct Parameters {
    double normal_stiffness;  ///< traction per opening, Pa/m
    double shear_stiffness;   ///< traction per slip, Pa/m
  };

  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    pull(pair, RelativeMotion<D, S>(pair), S(real<S>(p.normal_stiffness)), S(real<S>(p.shear_stiffness)), result);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_PULLS | MPM_COMPLIANT | MPM_ACTS_OVER_TIME;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(normal_stiffness, "Pa/m", required, 0.0, unbounded, 0,
                           "traction along the normal per distance by which the bodies have moved apart"),
      MPM_NUMBER_PARAMETER(shear_stiffness, "Pa/m", required, 0.0, unbounded, 0,
                           "traction across the normal per distance by which one has slid along the other"),
  };
#endif
};

}  // namespace mpm
