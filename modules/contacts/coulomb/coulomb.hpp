#pragma once
// Coulomb friction between two velocity fields at a node: normal velocities match while the surfaces press, the
// tangential impulse is limited by friction. Bardenhagen, Brackbill & Sulsky, Comput. Methods Appl. Mech. Engrg. 187
// (2000) 529-541.

#include "kernel/sliding.hpp"
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
    const RelativeMotion<D, S> motion(pair);
    const S speed = sqrt(motion.slide_squared);
    const scalar_of<S> kinetic = real<S>(p.friction);
    const scalar_of<S> limit = real<S>(p.static_friction > p.friction ? p.static_friction : p.friction);
    const auto sticks = speed <= limit * motion.approach;
    const S share = select(sticks, S(real<S>(1)), kinetic * motion.approach / max(speed, S(real<S>(1e-30))));
    strike(pair, motion, presses(pair, motion), share, sticks, result);
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
