// Turns momenta into velocities, applies conditions and forces, and accounts for the work of every impulse.

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {

void ReferenceBackend::momentum_to_velocity(const Pass& pass, const StepInfo& step) {
  const double before = accounted_ ? grid_.kinetic_energy() : 0.0;
  const bool accounts_heat = plan_.has_heat_ledger() && !pass.remap();
  const double heat = accounts_heat ? sum(heat_) : 0.0;
  grid_.fold_walls(step.time, pass.remap() ? 0.0 : step.dt);
  if (accounts_heat) heat_ledger_.images += sum(heat_) - heat;
  if (!pass.remap()) grid_.fold_forces();
  keep_free_velocity(false);
  impose_conditions(step.time);
  if (accounted_ && !pass.remap()) ledger_.boundary += grid_.kinetic_energy() - before;
  if (plan_.resolves_contact()) resolve_contact(step, false, pass.remap());
  for_each_node([&](std::size_t i) {
    velocity_[i] = over_mass(momentum_[i], i);
    if (!pass.remap()) velocity_before_[i] = velocity_[i];
  });
  measure_constraints();
  grid_.fill_velocity_ghosts(step.time);
}

/// Sets `constrained` to the velocity without what conditions and contact have added in this step.
void ReferenceBackend::keep_free_velocity(bool after_forces) {
  if (!keeps_constraints_) return;
  for_each_node([&](std::size_t i) {
    const Vector added = after_forces ? constrained_[i] : Vector(Vector::Zero());
    constrained_[i] = mass_[i] > 0 ? Vector(momentum_[i] / mass_[i] - added) : Vector(Vector::Zero());
  });
}

void ReferenceBackend::measure_constraints() {
  if (!keeps_constraints_) return;
  for_each_node([&](std::size_t i) { constrained_[i] = velocity_[i] - constrained_[i]; });
}

void ReferenceBackend::impose_conditions(double time) {
  for_each_node([&](std::size_t i) {
    if (mass_[i] <= 0) return;
    const Held held = grid_.held(i, momentum_[i] / mass_[i], time);
    for (int c = 0; c < 3; ++c) {
      held_[i][c] = held_[i][c] || held.component[c];
      if (held.component[c]) momentum_[i][c] = mass_[i] * held.velocity[c];
    }
  });
}

void ReferenceBackend::apply_forces(const StepInfo& step) {
  grid_.fold_forces();  // folds what USF scattered after the momenta were folded; the other forces are folded already
  for_each_node([&](std::size_t i) {
    momentum_[i] += step.dt * grid_.force(i);
    held_[i] = {};  // conditions after the forces decide whose the reaction is
  });
  keep_free_velocity(true);
  impose_conditions(step.time + step.dt);
  if (plan_.resolves_contact()) resolve_contact(step, true);
  for_each_node([&](std::size_t i) {
    velocity_[i] = over_mass(momentum_[i], i);
    if (accounted_ && mass_[i] > 0) account_for_impulses(i, step.dt);
  });
  measure_constraints();
  kinetic_energy_after_ = accounted_ ? grid_.kinetic_energy() : 0.0;
  grid_.fill_velocity_ghosts(step.time + step.dt);
}

/// Accounts for the work of every impulse between v- and v+ at their mean. What the forces do not explain is the
/// reaction of a condition on held components and of contact on the others.
void ReferenceBackend::account_for_impulses(std::size_t i, double dt) {
  const Vector mean = 0.5 * (velocity_before_[i] + velocity_[i]);
  const Vector reaction = mass_[i] * (velocity_[i] - velocity_before_[i]) - dt * grid_.force(i);
  ledger_.internal_force += dt * internal_force_[i].dot(mean);
  if (experiment_.body_force) ledger_.body_force += dt * body_force_[i].dot(mean);
  for (int c = 0; c < 3; ++c)
    (experiment_.gravity_has_potential(c) ? ledger_.gravity : ledger_.periodic_gravity) += dt * weight_[i][c] * mean[c];
  for (int c = 0; c < 3; ++c) (held_[i][c] ? ledger_.boundary : ledger_.contact) += reaction[c] * mean[c];
}

}  // namespace mpm::reference
