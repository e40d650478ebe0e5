// Turns momenta into velocities and applies conditions and forces.

#include <algorithm>
#include <cmath>

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {

void ReferenceBackend::momentum_to_velocity(const Pass& pass, const StepInfo& step) {
  if (notes_reactions_) reactions_.begin_step();
  if (!pass.remap()) rigid_.begin_step();
  const bool accounts_heat = plan_.has_heat_ledger() && !pass.remap();
  const double heat = accounts_heat ? sum(heat_) : 0.0;
  const double work_of_folds = grid_.fold_walls(step.time, pass.remap() ? 0.0 : step.dt);
  if (records_) book(&Ledger::boundary, work_of_folds);
  if (accounts_heat) heat_ledger_.images += sum(heat_) - heat;
  const double power_of_walls = pass.remap() ? 0.0 : grid_.fold_forces(step.time);
  if (records_) ledger_.boundary += step.dt * power_of_walls;
  keep_free_velocity(false);
  grid_.hold_grips_at_end(pass.remap());
  impose_conditions(step.time);
  if (plan_.resolves_contact()) resolve_contact(step, false, pass.remap());
  for_each_node([&](std::size_t i) {
    velocity_[i] = over_mass(momentum_[i], i);
    if (!pass.remap()) velocity_before_[i] = velocity_[i];
  });
  measure_constraints();
  if (notes_reactions_) reactions_.keep_before();
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
    const Vector before = momentum_[i];
    const std::vector<Held> all = grid_.held(i, momentum_[i] / mass_[i], time);
    for (const Held& held : all) momentum_[i][held.component] = mass_[i] * held.velocity;
    note_held(all, i, momentum_[i] - before);
    if (!all.empty()) record(boundary_impulse_, standing_boundary_impulse_, i, momentum_[i] - before);
  });
}

/// Notes the impulse that a node takes from its supports: of those that hold a component the last one gives all of it.
void ReferenceBackend::note_held(const std::vector<Held>& all, std::size_t i, const Vector& given) {
  if (!notes_reactions_) return;
  for (int c = 0; c < experiment_.dimension; ++c) {
    const auto holder = std::find_if(all.rbegin(), all.rend(), [&](const Held& held) { return held.component == c; });
    if (holder == all.rend()) continue;
    Vector3 impulse{};
    impulse[c] = given[c];
    reactions_.hold(holder->support, as_array(grid_.position(grid_.coordinates(i))), impulse);
  }
}

/// Damps the motion: a share of the unbalanced force, by which all that acts has changed the velocity, acts against each
/// component, and -c m v. Supports hold what they held.
void ReferenceBackend::damp(const StepInfo& step) {
  const double c = experiment_.damping.viscous, decay = std::exp(-c * step.dt);
  // A constant acceleration a makes v+ = exp(-c dt) v- + a (1 - exp(-c dt)) / c.
  const double mean_decay = c > 0 ? (1 - decay) / (c * step.dt) : 1;
  for_each_node([&](std::size_t i) {
    if (mass_[i] <= 0) return;
    Vector gain = velocity_[i] - velocity_before_[i];
    for (int axis = 0; axis < experiment_.dimension; ++axis)
      if (velocity_[i][axis] != 0)
        gain[axis] -= experiment_.damping.local * std::copysign(gain[axis], velocity_[i][axis]);
    const Vector damped = decay * velocity_before_[i] + mean_decay * gain;
    if (records_) damping_impulse_[i] += mass_[i] * (damped - velocity_[i]);
    momentum_[i] = mass_[i] * damped;
  });
  keep_free_velocity(true);
  impose_conditions(step.time + step.dt);
  for_each_node([&](std::size_t i) { velocity_[i] = over_mass(momentum_[i], i); });
  measure_constraints();
}

/// Records what particles take from the supports when they gather the velocity as it is now.
void ReferenceBackend::record_reactions(const StepInfo& step) {
  if (!notes_reactions_) return;
  grid_.note_gather();
  reactions_.record(step);
}

void ReferenceBackend::apply_forces(const StepInfo& step) {
  // This folds what USF scattered after the momenta were folded; the other forces are folded already.
  const double power_of_walls = grid_.fold_forces(step.time + step.dt);
  if (records_) ledger_.boundary += step.dt * power_of_walls;
  for_each_node([&](std::size_t i) { momentum_[i] += step.dt * grid_.force(i); });
  keep_free_velocity(true);
  grid_.hold_grips_at_end(true);
  impose_conditions(step.time + step.dt);
  if (plan_.resolves_contact()) resolve_contact(step, true);
  for_each_node([&](std::size_t i) { velocity_[i] = over_mass(momentum_[i], i); });
  measure_constraints();
  if (experiment_.damping.acts()) damp(step);
  if (records_) book_forces(step.dt);
  grid_.fill_velocity_ghosts(step.time + step.dt);
  if (notes_reactions_) reactions_.apply_forces(step.dt);
  record_reactions(step);
  rigid_.end_step(step);
}

}  // namespace mpm::reference
