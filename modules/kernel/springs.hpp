#pragma once
// How springs spread over a surface join two bodies at a node: what laws of compliant interfaces share. Device-safe.

#include "kernel/sliding.hpp"

namespace mpm {

/// The impulse of a spring over one step, per reduced mass: `of_speed` times the relative speed plus `of_displacement`
/// times how far the ends have moved apart.
template <class S>
struct SpringImpulse {
  S of_speed;         ///< pure number
  S of_displacement;  ///< 1/s
  S holds;            ///< 1 where the spring is too stiff for the step, and holds the pair together as a weld, else 0
};

/// The oscillator m d'' + k d = 0, integrated exactly over a step: with x = k dt^2 / m = theta^2 the impulse on a mass m is
/// m (w (1 - cos theta) + d theta sin theta / dt), for the relative speed w and the displacement d at the start. A spring
/// with x >= 1 would turn by more than a sixth of its period in a step: it holds its pair. Before the forces a spring that
/// does not hold gives nothing.
template <class S>
MPM_HD SpringImpulse<S> spring_impulse(S stiffness, S mass, scalar_of<S> dt, bool after_forces) {
  const scalar_of<S> one = 1;
  const S x = stiffness * dt * dt / mass;
  const auto holds = x >= one;
  const S below = min(x, S(one));
  // (1 - cos theta) / x and sin theta / theta are series in x that end below rounding where x <= 1.
  S cosine(one), sine(one);
  for (int k = 9; k > 0; --k) {
    cosine = one - below / real<S>((2 * k + 1) * (2 * k + 2)) * cosine;
    sine = one - below / real<S>(2 * k * (2 * k + 1)) * sine;
  }
  const S acts(real<S>(after_forces ? 1 : 0));
  return {select(holds, S(one), acts * below * real<S>(0.5) * cosine),
          select(holds, S(real<S>(0)), acts * below / dt * sine), select(holds, S(one), S(real<S>(0)))};
}

/// Lets springs of these stiffnesses, Pa/m, pull along the normal and across it. What they do not hold keeps its energy:
/// what the bodies lose the springs have.
template <int D, class S>
MPM_HD void pull(const ContactPair<D, S>& pair, const RelativeMotion<D, S>& motion, S normal_stiffness,
                 S shear_stiffness, ContactResult<D, S>& result) {
  const scalar_of<S> zero = 0, one = 1, half = real<S>(0.5);
  const S mass = motion.reduced_mass;
  const auto along = spring_impulse<S>(normal_stiffness * pair.area, mass, pair.dt, pair.after_forces);
  const auto across = spring_impulse<S>(shear_stiffness * pair.area, mass, pair.dt, pair.after_forces);
  S opening(zero), largest(zero), stored(zero);
  for (int i = 0; i < D; ++i) opening = opening + pair.displacement[i] * pair.normal[i];
  const S normal_change = along.of_speed * -motion.approach + along.of_displacement * opening;
  stored = (one - along.holds) * normal_change * (-motion.approach - half * normal_change);
  for (int i = 0; i < D; ++i) {
    const S shear = pair.displacement[i] - opening * pair.normal[i];
    const S change = across.of_speed * motion.slide[i] + across.of_displacement * shear;
    stored = stored + (one - across.holds) * change * (motion.slide[i] - half * change);
    result.impulse[i] = mass * (normal_change * pair.normal[i] + change);
    largest = max(largest, max(result.impulse[i], -result.impulse[i]));
  }
  result.stored = mass * stored;
  result.dissipated = S(zero);
  result.status = select(largest > zero, select(along.holds * across.holds > zero, S(one), S(real<S>(2))), S(zero));
}

}  // namespace mpm
