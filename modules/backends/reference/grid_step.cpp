// Momenta to velocities, conditions, forces, and the work of every impulse.

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {
namespace {

void accelerate(Node& node, double dt) {
  node.momentum += dt * node.force();
  std::fill(node.held, node.held + 3, false);  // conditions after the forces decide whose the reaction is
}

}  // namespace

void ReferenceBackend::momentum_to_velocity(const Pass& pass, const StepInfo& step) {
  const double before = accounted_ ? grid_.kinetic_energy() : 0.0;
  grid_.fold_walls(step.time, pass.remap() ? 0.0 : step.dt, pass.remap());
  if (!pass.remap()) grid_.fold_forces();
  keep_free_velocity(false);
  impose_conditions(step.time);
  if (accounted_ && !pass.remap()) ledger_.boundary += grid_.kinetic_energy() - before;
  if (plan_.contact) resolve_contact(step, false, pass.remap());
  for (int field = 0; field < grid_.field_count(); ++field)
    for (std::size_t i = 0; i < grid_.node_count(); ++i) {
      Node& node = grid_.node(field, i);
      node.velocity = node.mass > 0 ? Vector(node.momentum / node.mass) : Vector(Vector::Zero());
      if (!pass.remap()) node.velocity_before = node.velocity;
    }
  measure_constraints();
  grid_.fill_ghosts(step.time);
}

/// `constrained` <- the velocity without what conditions and contact have added in this step.
void ReferenceBackend::keep_free_velocity(bool after_forces) {
  if (!plan_.constrained_velocity) return;
  for_each_node([&](Node& node) {
    const Vector added = after_forces ? node.constrained : Vector(Vector::Zero());
    node.constrained = node.mass > 0 ? Vector(node.momentum / node.mass - added) : Vector(Vector::Zero());
  });
}

void ReferenceBackend::measure_constraints() {
  if (!plan_.constrained_velocity) return;
  for_each_node([](Node& node) { node.constrained = node.velocity - node.constrained; });
}

void ReferenceBackend::impose_conditions(double time) {
  for (int field = 0; field < grid_.field_count(); ++field)
    for (std::size_t i = 0; i < grid_.node_count(); ++i) {
      Node& node = grid_.node(field, i);
      if (node.mass <= 0) continue;
      const Held held = grid_.held(i, node.momentum / node.mass, time);
      for (int c = 0; c < 3; ++c) {
        node.held[c] = node.held[c] || held.component[c];
        if (held.component[c]) node.momentum[c] = node.mass * held.velocity[c];
      }
    }
}

void ReferenceBackend::apply_forces(const StepInfo& step) {
  grid_.fold_forces();  // forces that USF scattered after the momenta were folded; nothing is left of the others
  for (int field = 0; field < grid_.field_count(); ++field)
    for (std::size_t i = 0; i < grid_.node_count(); ++i) accelerate(grid_.node(field, i), step.dt);
  keep_free_velocity(true);
  impose_conditions(step.time + step.dt);
  if (plan_.contact) resolve_contact(step, true);
  for (int field = 0; field < grid_.field_count(); ++field)
    for (std::size_t i = 0; i < grid_.node_count(); ++i) {
      Node& node = grid_.node(field, i);
      node.velocity = node.mass > 0 ? Vector(node.momentum / node.mass) : Vector(Vector::Zero());
      if (accounted_ && node.mass > 0) account_for_impulses(node, step.dt);
    }
  measure_constraints();
  kinetic_energy_after_ = accounted_ ? grid_.kinetic_energy() : 0.0;
  grid_.fill_ghosts(step.time + step.dt);
}

/// Work of every impulse between v- and v+ at their mean. What the forces do not explain is the reaction of a
/// condition on held components and of contact on the others.
void ReferenceBackend::account_for_impulses(const Node& node, double dt) {
  const Vector mean = 0.5 * (node.velocity_before + node.velocity);
  const Vector reaction = node.mass * (node.velocity - node.velocity_before) - dt * node.force();
  ledger_.internal_force += dt * node.internal_force.dot(mean);
  ledger_.body_force += dt * node.body_force.dot(mean);
  ledger_.gravity += dt * node.gravity_force.dot(mean);
  for (int c = 0; c < 3; ++c) (node.held[c] ? ledger_.boundary : ledger_.contact) += reaction[c] * mean[c];
}

}  // namespace mpm::reference
