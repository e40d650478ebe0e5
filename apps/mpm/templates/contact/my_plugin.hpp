#pragma once
// Friction with a limit (Orowan 1943): a pair of bodies slides where the shear stress would exceed min(mu p, k), p the
// pressure of contact and k the shear strength of the softer side. Impulses at one node of area A over the step dt:
//   J_n = m v_n  (normal velocities become equal),   |J_t| <= min(mu J_n, k A dt),   m = m_a m_b / (m_a + m_b)
// Detection and the two velocity fields: Bardenhagen, Brackbill & Sulsky (2000), Comput. Methods Appl. Mech. Engrg.
// 187:529-541.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MyPlugin {
  struct Parameters {
    double friction, shear_strength;
  };

  /// The impulse is added to body a and taken from b; `normal` points from a to b.
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const S zero = S(real<S>(0)), one = S(real<S>(1));
    const S mass = pair.mass_a / (real<S>(1) + pair.mass_a / pair.mass_b);  // b may be a rigid body, of infinite mass
    Vec<D, S> slide;  // velocity of b seen from a, then its part in the plane of contact
    S approach = zero, squared = zero;
    for (int i = 0; i < D; ++i) {
      slide[i] = pair.momentum_b[i] / pair.mass_b - pair.momentum_a[i] / pair.mass_a;
      approach = approach - slide[i] * pair.normal[i];
    }
    for (int i = 0; i < D; ++i) {
      slide[i] = slide[i] + approach * pair.normal[i];
      squared = squared + slide[i] * slide[i];
    }
    const S speed = sqrt(squared);
    const S limit = min(real<S>(p.friction) * approach, real<S>(p.shear_strength) * pair.area * pair.dt / mass);
    const auto sticks = speed <= limit;  // both are velocities: what the tangential impulse can change
    const S share = select(sticks, one, limit / max(speed, S(real<S>(1e-30))));
    const S active = select(approach > zero, select(pair.separation <= zero, one, zero), zero);
    for (int i = 0; i < D; ++i) result.impulse[i] = active * mass * (share * slide[i] - approach * pair.normal[i]);
    // Work of the tangential impulse at the mean sliding speed; a pair that sticks does none.
    result.dissipated = active * select(sticks, zero, mass * share * squared * (one - real<S>(0.5) * share));
    result.status = active * select(sticks, one, S(real<S>(2)));
  }

#if MPM_HOST
  static constexpr unsigned traits = 0;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(friction, "", 0.0, 0.0, unbounded, 0, "coefficient of friction mu"),
      MPM_NUMBER_PARAMETER(shear_strength, "Pa", required, 0.0, unbounded, 0,
                           "shear stress k that friction never exceeds"),
  };
#endif
};

}  // namespace mpm
