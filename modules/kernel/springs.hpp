#pragma once
// How springs spread over a surface join two bodies at a node: what laws of compliant interfaces share. Device-safe.

#include "kernel/sliding.hpp"

namespace mpm {

/// The impulse of a spring over one step, per reduced mass: `of_speed` times the relative speed plus `of_displacement`
/// times how far the ends have moved apart.
template <class S>
struct SpringImpulse {
  S of_speed;         ///< pure number: the share of a weld in it, 1 where the spring is far too stiff for the step
  S of_displacement;  ///< 1/s
  S stiffness;        ///< k dt^2 / m of the spring's own share, pure number
};

/// The oscillator m d'' + k d = 0 over a step after which the ends move on with the new speed, d <- d + w dt. With theta^2 =
/// k dt^2 / m the kick w <- w - 2 (1 - cos theta) d / dt puts d on the exact sinusoid at every step and keeps its
/// amplitude; that of the oscillator's own end, w cos theta - d theta sin theta / dt, would lose a share theta^2 / 2 of it
/// in each step. Where the pair would turn by more than a radian in a step the spring gives way to a weld, wholly from
/// theta^2 = 2 on. Before the forces the weld's part alone acts.
template <class S>
MPM_HD SpringImpulse<S> spring_impulse(S stiffness, S mass, scalar_of<S> dt, bool after_forces) {
  const scalar_of<S> zero = 0, one = 1, two = 2;
  const S squared = min(stiffness * dt * dt / mass, S(two));
  const S weld = max(squared - one, S(zero));
  // 2 (1 - cos theta) / theta^2 is a series in theta^2 that ends below rounding.
  S series(one);
  for (int k = 11; k > 0; --k) series = one - squared / real<S>((2 * k + 1) * (2 * k + 2)) * series;
  const S springs = after_forces ? one - weld : S(zero);
  return {weld, springs * squared * series / dt, springs * squared};
}

/// Lets springs of these stiffnesses, Pa/m, pull along the normal and across it. They store k ((d + w dt)^2 - d^2) / 2 of the
/// move that follows with the new speed w, which is nothing where a load holds the pair at rest on its springs.
template <int D, class S>
MPM_HD void pull(const ContactPair<D, S>& pair, const RelativeMotion<D, S>& motion, S normal_stiffness,
                 S shear_stiffness, ContactResult<D, S>& result) {
  const scalar_of<S> zero = 0, one = 1, half = real<S>(0.5), two = 2;
  const S mass = motion.reduced_mass;
  const auto along = spring_impulse<S>(normal_stiffness * pair.area, mass, pair.dt, pair.after_forces);
  const auto across = spring_impulse<S>(shear_stiffness * pair.area, mass, pair.dt, pair.after_forces);
  S opening(zero), largest(zero);
  for (int i = 0; i < D; ++i) opening = opening + pair.displacement[i] * pair.normal[i];
  const S closing = along.of_displacement * opening - along.of_speed * motion.approach;
  const S parting = -motion.approach - closing;
  S taken = along.stiffness * parting * (two * opening / pair.dt + parting);
  for (int i = 0; i < D; ++i) {
    const S shear = pair.displacement[i] - opening * pair.normal[i];
    const S change = across.of_speed * motion.slide[i] + across.of_displacement * shear;
    const S sliding = motion.slide[i] - change;
    taken = taken + across.stiffness * sliding * (two * shear / pair.dt + sliding);
    result.impulse[i] = mass * (closing * pair.normal[i] + change);
    largest = max(largest, max(result.impulse[i], -result.impulse[i]));
  }
  result.stored = half * mass * taken;
  result.dissipated = S(zero);
  const S welds = select(along.of_speed * across.of_speed < one, S(zero), S(one));
  result.status = select(largest > zero, real<S>(2) - welds, S(zero));
}

}  // namespace mpm
