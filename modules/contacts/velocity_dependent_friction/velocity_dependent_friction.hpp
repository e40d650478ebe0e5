#pragma once
// Friction whose coefficient depends on the sliding speed v: mu(v) = mu_k + (mu_s - mu_k) exp(-v / v_d), from static at
// rest to kinetic far above the decay speed. Benson & Hallquist, Comput. Methods Appl. Mech. Engrg. 78 (1990) 141-163.

#include "kernel/sliding.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct VelocityDependentFriction {
  struct Parameters {
    double friction;         ///< mu_k, the coefficient at high speed
    double static_friction;  ///< mu_s, the coefficient at rest; it may be the smaller of the two
    double decay_speed;      ///< v_d, m/s
  };

  /// The speed v that is left of a sliding speed v0 solves v + mu(v) u = v0, with u the speed of approach, and is that of
  /// the step's end: no step overshoots it. Where v0 > mu_s u it has one solution in (0, v0): the left side less v0 is
  /// below 0 at 0 and above at v0, and convex where friction falls with speed, concave and growing where it rises.
  /// Newton's method from v0 then comes down to it, or passes it once and comes up. Rounds that have not arrived leave
  /// friction that the law allows at the speed that is left, or less.
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const scalar_of<S> zero = 0, one = 1;
    const RelativeMotion<D, S> motion(pair);
    const S speed = sqrt(motion.slide_squared);
    const S approach = max(motion.approach, S(zero));
    const scalar_of<S> kinetic = real<S>(p.friction), excess = real<S>(p.static_friction - p.friction);
    const scalar_of<S> rate = real<S>(1 / p.decay_speed);
    const auto sticks = speed <= real<S>(p.static_friction) * approach;
    S left = speed, decayed = exp(-rate * left);
    for (int round = 0; round < rounds; ++round) {
      const S beyond = left + (kinetic + excess * decayed) * approach - speed;
      const S slope = one - excess * rate * decayed * approach;
      left = max(left - select(slope > zero, beyond / slope, S(zero)), S(zero));
      decayed = exp(-rate * left);
    }
    const S friction = kinetic + excess * decayed;
    const S share = select(sticks, S(one), friction * approach / max(speed, S(real<S>(1e-30))));
    strike(pair, motion, presses(pair, motion), share, sticks, result);
  }

  static constexpr int rounds = 8;

#if MPM_HOST
  static constexpr unsigned traits = 0;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(friction, "", 0.0, 0.0, unbounded, 0, "coefficient of friction far above `decay_speed`"),
      MPM_NUMBER_PARAMETER(static_friction, "", 0.0, 0.0, unbounded, 0,
                           "coefficient at rest; below `friction` it rises with the speed"),
      MPM_NUMBER_PARAMETER(
          decay_speed, "m/s", required, 1e-12, unbounded, 0,
          "sliding speed over which the coefficient goes from one to the other, by exp(-v / decay_speed)"),
  };
#endif
};

}  // namespace mpm
