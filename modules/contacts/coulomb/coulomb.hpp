#pragma once
// Coulomb friction between two velocity fields at a node: normal velocities match while the surfaces press, the
// tangential impulse is limited by friction. Bardenhagen, Brackbill & Sulsky, Comput. Methods Appl. Mech. Engrg. 187
// (2000) 529-541.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Coulomb {
  struct Parameters {
    double friction;         ///< kinetic coefficient
    double static_friction;  ///< coefficient up to which the pair sticks; below `friction` it counts as `friction`
  };

  /// The pair acts when it approaches and the surfaces touch (separation <= 0).
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const scalar_of<S> zero = 0, one = 1;
    const S reduced_mass = pair.mass_a * pair.mass_b / (pair.mass_a + pair.mass_b);
    Vec<D, S> jump;  // velocity of b seen from a
    S approach = S(zero);
    for (int i = 0; i < D; ++i) {
      jump[i] = pair.momentum_b[i] / pair.mass_b - pair.momentum_a[i] / pair.mass_a;
      approach = approach - jump[i] * pair.normal[i];
    }
    S slide_squared = S(zero);
    Vec<D, S> slide;
    for (int i = 0; i < D; ++i) {
      slide[i] = jump[i] + approach * pair.normal[i];
      slide_squared = slide_squared + slide[i] * slide[i];
    }
    const S speed = sqrt(slide_squared);
    const scalar_of<S> kinetic = real<S>(p.friction);
    const scalar_of<S> limit = real<S>(p.static_friction > p.friction ? p.static_friction : p.friction);
    const auto sticks = speed <= limit * approach;
    const S share = select(sticks, S(one), kinetic * approach / max(speed, S(real<S>(1e-30))));
    const S active = select(approach > zero, select(pair.separation <= zero, S(one), S(zero)), S(zero));
    for (int i = 0; i < D; ++i)
      result.impulse[i] = active * reduced_mass * (share * slide[i] - approach * pair.normal[i]);
    // Work of the tangential impulse at the mean sliding speed; a pair that sticks loses only what single-field MPM
    // would.
    result.dissipated =
        active * select(sticks, S(zero), reduced_mass * share * slide_squared * (one - real<S>(0.5) * share));
    result.status = active * select(sticks, S(one), S(real<S>(2)));
  }

#if MPM_HOST
  static constexpr unsigned traits = 0;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(friction, "", 0.0, 0.0, unbounded, 0, "kinetic coefficient of friction; 0 is frictionless"),
      MPM_NUMBER_PARAMETER(static_friction, "", 0.0, 0.0, unbounded, 0,
                           "static coefficient; the larger of the two counts"),
  };
#endif
};

}  // namespace mpm
