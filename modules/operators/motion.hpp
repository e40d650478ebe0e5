#pragma once
// Formulas for the velocity of a node between scatter and gather, and for the work done on it. A velocity V may be one
// component, a vector of them, or a pack of several nodes; products are taken component by component. M is the mass,
// one number or the same one in every component.

#include "kernel/config.hpp"

namespace mpm {

template <class V, class M>
MPM_HD V velocity_of(V momentum, M mass) {
  return momentum / mass;
}

/// The velocity after the forces and gravity: v + dt (f / m + g).
template <class V, class M, class S>
MPM_HD V accelerated(V velocity, V force, M mass, V gravity, S dt) {
  return velocity + dt * (force / mass + gravity);
}

/// The velocity after an impulse.
template <class V, class M>
MPM_HD V struck(V velocity, V impulse, M mass) {
  return velocity + impulse / mass;
}

/// Twice the kinetic energy of each component.
template <class V, class M>
MPM_HD V twice_kinetic_energy(V velocity, M mass) {
  return mass * (velocity * velocity);
}

/// The velocity at which a force does work: the mean of the velocities before and after the forces.
template <class V>
MPM_HD V mean_velocity(V before, V after) {
  return 0.5 * (before + after);
}

/// One component of the velocity that damping leaves of what forces, supports and contact make of `before`: of the
/// change the share `local` acts against the motion (Cundall 1987, whose unbalanced force is m times the change over
/// dt), and a force -c m v acts besides, integrated exactly under a constant acceleration: `left_of_velocity` is
/// exp(-c dt), `left_of_change` (1 - exp(-c dt)) / (c dt). No step is too long for it.
template <class S>
MPM_HD S damped(S before, S after, S local, S left_of_velocity, S left_of_change) {
  const S change = after - before, size = change < S(0) ? -change : change;
  const S against = after > S(0) ? -size : after < S(0) ? size : S(0);
  return left_of_velocity * before + left_of_change * (change + local * against);
}

}  // namespace mpm
