#pragma once
// Bodies that hold together while tension and shear stay within an ellipse of strengths. Nairn, CMES 92 (2013) 271-299,
// section on adhesion; the traction is that around a node, which a single node does not know.

#include "kernel/sliding.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Adhesion {
  struct Parameters {
    double normal_strength;  ///< tension that alone parts the bodies, Pa
    double shear_strength;   ///< shear traction that alone makes them slide, Pa
    double friction;         ///< kinetic and static coefficient once they have parted
    double reach;            ///< separation up to which they hold, cells
  };

  /// 1 where the pair holds, else 0. Nothing holds before the forces: what resists in both stages resists with twice the
  /// strength over the step.
  template <int D, class S>
  MPM_HD static S holds(const Parameters& p, const ContactPair<D, S>& pair) {
    const scalar_of<S> zero = 0, one = 1;
    S along(zero), tension_used(zero), shear_used(zero);
    for (int i = 0; i < D; ++i) along = along + pair.traction[i] * pair.normal[i];
    tension_used = max(along, S(zero)) / real<S>(p.normal_strength);
    for (int i = 0; i < D; ++i) {
      const S shear = (pair.traction[i] - along * pair.normal[i]) / real<S>(p.shear_strength);
      shear_used = shear_used + shear * shear;
    }
    const S most(pair.after_forces ? one : zero);
    const S inside = select(tension_used * tension_used + shear_used < most, S(one), S(zero));
    return select(pair.separation <= real<S>(p.reach) * pair.cell_size, inside, S(zero));
  }

  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const scalar_of<S> one = 1, friction = real<S>(p.friction);
    const RelativeMotion<D, S> motion(pair);
    const S held = holds(p, pair), speed = sqrt(motion.slide_squared);
    const auto sticks = max(held, select(speed <= friction * motion.approach, S(one), S(real<S>(0)))) > real<S>(0.5);
    const S share = select(sticks, S(one), friction * motion.approach / max(speed, S(real<S>(1e-30))));
    strike(pair, motion, max(held, presses(pair, motion)), share, sticks, result);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_PULLS | MPM_READS_TRACTION | MPM_ACTS_OVER_TIME;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(normal_strength, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "tension that alone parts the bodies"),
      MPM_NUMBER_PARAMETER(shear_strength, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "shear traction that alone makes them slide"),
      MPM_NUMBER_PARAMETER(friction, "", 0.0, 0.0, unbounded, 0, "coefficient of friction once they have parted"),
      MPM_NUMBER_PARAMETER(reach, "", 0.25, 0.0, 1.0, 0, "separation up to which they hold together, cells"),
  };
#endif
};

}  // namespace mpm
