// Turns momenta into velocities and applies conditions and forces.

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {

void ReferenceBackend::momentum_to_velocity(const Pass& pass, const StepInfo& step) {
  const bool accounts_heat = plan_.has_heat_ledger() && !pass.remap();
  const double heat = accounts_heat ? sum(heat_) : 0.0;
  const double work_of_folds = grid_.fold_walls(step.time, pass.remap() ? 0.0 : step.dt);
  if (records_) book(&Ledger::boundary, work_of_folds);
  if (accounts_heat) heat_ledger_.images += sum(heat_) - heat;
  const double power_of_walls = pass.remap() ? 0.0 : grid_.fold_forces(step.time);
  if (records_) ledger_.boundary += step.dt * power_of_walls;
  keep_free_velocity(false);
  impose_conditions(step.time);
  if (plan_.resolves_contact()) resolve_contact(step, false, pass.remap());
  for_each_node([&](std::size_t i) {
    velocity_[i] = over_mass(momentum_[i], i);
    if (!pass.remap()) velocity_before_[i] = velocity_[i];
  });
  measure_constraints();
  if (records_) book_impulses();
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
    const Vector before = momentum_[i];
    for (int c = 0; c < 3; ++c)
      if (held.component[c]) momentum_[i][c] = mass_[i] * held.velocity[c];
    if (held.any()) record(boundary_impulse_, standing_boundary_impulse_, i, momentum_[i] - before);
  });
}

void ReferenceBackend::apply_forces(const StepInfo& step) {
  // This folds what USF scattered after the momenta were folded; the other forces are folded already.
  const double power_of_walls = grid_.fold_forces(step.time + step.dt);
  if (records_) ledger_.boundary += step.dt * power_of_walls;
  for_each_node([&](std::size_t i) { momentum_[i] += step.dt * grid_.force(i); });
  keep_free_velocity(true);
  impose_conditions(step.time + step.dt);
  if (plan_.resolves_contact()) resolve_contact(step, true);
  for_each_node([&](std::size_t i) { velocity_[i] = over_mass(momentum_[i], i); });
  measure_constraints();
  if (records_) book_forces(step.dt);
  grid_.fill_velocity_ghosts(step.time + step.dt);
}

}  // namespace mpm::reference
