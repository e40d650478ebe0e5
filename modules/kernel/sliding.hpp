#pragma once
// How two bodies move past one another at a node, and the impulse that makes their normal velocities equal and slows
// their sliding: what laws of friction share. Device-safe.

#include "kernel/functor.hpp"

namespace mpm {

/// The reduced mass of a pair, kg; that of a where b is infinite. No product of masses is made, which overflows in float
/// beyond 1e19 kg.
template <class S>
MPM_HD S reduced_mass_of(S mass_a, S mass_b) {
  return mass_a / (real<S>(1) + mass_a / mass_b);
}

/// The relative motion of a pair: b seen from a.
template <int D, class S>
struct RelativeMotion {
  S reduced_mass;   ///< kg
  S approach;       ///< along the normal, m/s, positive where the bodies come together
  Vec<D, S> slide;  ///< across the normal, m/s
  S slide_squared;  ///< m^2/s^2

  MPM_HD explicit RelativeMotion(const ContactPair<D, S>& pair)
      : reduced_mass(reduced_mass_of(pair.mass_a, pair.mass_b)), approach(real<S>(0)), slide_squared(real<S>(0)) {
    Vec<D, S> jump;
    for (int i = 0; i < D; ++i) {
      jump[i] = pair.momentum_b[i] / pair.mass_b - pair.momentum_a[i] / pair.mass_a;
      approach = approach - jump[i] * pair.normal[i];
    }
    for (int i = 0; i < D; ++i) {
      slide[i] = jump[i] + approach * pair.normal[i];
      slide_squared = slide_squared + slide[i] * slide[i];
    }
  }
};

/// Whether the pair approaches and its surfaces touch: 1 or 0.
template <int D, class S>
MPM_HD S presses(const ContactPair<D, S>& pair, const RelativeMotion<D, S>& motion) {
  const scalar_of<S> zero = 0, one = 1;
  return select(motion.approach > zero, select(pair.separation <= zero, S(one), S(zero)), S(zero));
}

/// The impulse that ends the approach and takes `share` of the sliding, all of it where the pair sticks, times `active`.
/// The work of its tangential part at the mean sliding speed is heat; a pair that sticks loses only what single-field MPM
/// would.
template <int D, class S, class Mask>
MPM_HD void strike(const ContactPair<D, S>& pair, const RelativeMotion<D, S>& motion, S active, S share, Mask sticks,
                   ContactResult<D, S>& result) {
  const scalar_of<S> zero = 0, one = 1;
  for (int i = 0; i < D; ++i)
    result.impulse[i] = active * motion.reduced_mass * (share * motion.slide[i] - motion.approach * pair.normal[i]);
  result.dissipated =
      active *
      select(sticks, S(zero), motion.reduced_mass * share * motion.slide_squared * (one - real<S>(0.5) * share));
  result.status = active * select(sticks, S(one), S(real<S>(2)));
}

}  // namespace mpm
