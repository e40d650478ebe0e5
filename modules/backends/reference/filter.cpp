// A velocity filter applies a truncated series in I - S+ S to the grid's velocity, with S+ the gather (grid to
// particles to grid: S+ S, mass-weighted) (Hammerquist & Nairn 2017, CMAME 318:724, XPIC; Nairn & Hammerquist 2021,
// CMAME 377:113667, FMPM). The loop is incremental: v* <- what is left, v <- v + what the plugin takes of it, and conditions and
// contact correct v, whose net change becomes v*. One-sided laws (contact, separating walls) are given the sum of all
// increments before they acted, so an impulse that a later increment no longer needs is taken back (Nairn 2026,
// arXiv 2604.07307).

#include <algorithm>
#include <cmath>

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {
namespace {

/// The time of the wall's velocity: that of v- before the forces, of v+ after them.
double time_of(const Pass& pass, const StepInfo& step) {
  return pass.stage == Stage::after_forces ? step.time + step.dt : step.time;
}

}  // namespace

void ReferenceBackend::begin_filter(const Pass& pass) {
  for_each_node([&](std::size_t i) {
    increment_[i] = velocity_[i];
    if (pass.stage == Stage::before_forces) unfiltered_[i] = velocity_[i];
    if (pass.stage == Stage::before_forces && keeps_constraints_) unfiltered_constrained_[i] = constrained_[i];
  });
  if (pass.stage == Stage::before_forces) impulse_.keep(), reactions_.keep();
  filter_.iterations = 0;
  filter_.first_norm = filter_.last_norm = grid_.mass_norm(increment_);
}

/// Sets projection <- S+ S v*, by the transfer's own gather and scatter of particles that were at rest.
void ReferenceBackend::project(const Pass& pass, const StepInfo& step) {
  for_each_node([&](std::size_t i) { projection_[i] = Vector::Zero(); });
  for (Particles& body : bodies_) {
    gather_moments(body, increment_);
    body.project_coefficients(step.dt);
    scatter_affine(body, projection_);
  }
  // The first increment is a velocity, which a moving wall mirrors about its own; later ones are differences.
  const bool difference = filter_.iterations > 0;
  grid_.note_gather_of(increment_);
  grid_.fold_as(projection_, AtWall::momentum, difference ? std::nullopt : std::optional(time_of(pass, step)));
  for_each_node([&](std::size_t i) { projection_[i] = over_mass(projection_[i], i); });
}

void ReferenceBackend::update_filter(const Pass& pass, const StepInfo& step) {
  for (int field = 0; field < grid_.velocity_fields(); ++field) call_filter(field);
  if (notes_reactions_) reactions_.take_projection(static_cast<int>(filter_.iterations + 1));
  if (experiment_.filter_schedule.constrain_always) {
    for_each_node([&](std::size_t i) { trial_velocity_[i] = velocity_[i]; });
    constrain_free_velocity(pass, step);
    // What conditions and contact changed is a part of this pass's change of v.
    for_each_node([&](std::size_t i) { increment_[i] += velocity_[i] - trial_velocity_[i]; });
  }
  filter_.take_norm(grid_.mass_norm(increment_));
  grid_.fill_ghosts(increment_, AtWall::vector);
}

/// Calls the plugin's update at all nodes of a field that hold mass.
void ReferenceBackend::call_filter(int field) {
  std::vector<std::size_t> nodes;
  for (std::size_t i = grid_.at(field, 0); i < grid_.at(field + 1, 0); ++i)
    if (mass_[i] > 0) nodes.push_back(i);
  if (nodes.empty()) return;
  const int D = experiment_.dimension;
  const std::size_t n = (nodes.size() + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
  Array projected = Array::Zero(D, static_cast<Eigen::Index>(n)), increment = projected, velocity = projected;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = nodes[std::min(k, nodes.size() - 1)];  // the last node fills the pack
    for (int c = 0; c < D; ++c)
      projected(c, k) = projection_[i][c], increment(c, k) = increment_[i][c], velocity(c, k) = velocity_[i][c];
  }
  const mpm_filter_batch batch{static_cast<std::uint32_t>(n),
                               static_cast<std::uint32_t>(n),
                               static_cast<std::uint32_t>(D),
                               static_cast<std::uint32_t>(filter_.iterations + 1),
                               projected.data(),
                               increment.data(),
                               velocity.data()};
  const Component& filter = *experiment_.filter;
  filter.plugin->filter().update[MPM_SCALAR_DOUBLE][D - 2](filter.parameters.data(), &batch);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Vector taken = Vector::Zero();
    for (int c = 0; c < D; ++c) {
      increment_[nodes[k]][c] = increment(c, k);
      taken[c] = velocity(c, k) - velocity_[nodes[k]][c];
    }
    velocity_[nodes[k]] += taken;
    if (records_) filter_impulse_[nodes[k]] += mass_[nodes[k]] * taken;
  }
}

void ReferenceBackend::end_filter(const Pass& pass, const StepInfo& step) {
  if (!experiment_.filter_schedule.constrain_always) constrain_free_velocity(pass, step);
  grid_.fill_velocity_ghosts(time_of(pass, step));
  if (pass.stage == Stage::before_forces) return;  // the momentum stays that of the velocity kept aside
  for_each_node([&](std::size_t i) { momentum_[i] = mass_[i] * velocity_[i]; });
  if (records_) book_filter();
  record_reactions(step);
}

void ReferenceBackend::restore_velocity(const Pass& pass, const StepInfo& step) {
  if (accounted_ && !pass.has(Act::keep_correction)) book_filtered_strain(step.dt);
  const auto restore = [&](Vector& value, Vector& unfiltered) {
    std::swap(value, unfiltered);
    if (pass.has(Act::keep_correction)) unfiltered -= value;
  };
  impulse_.restore(pass.has(Act::keep_correction));
  reactions_.restore(pass.has(Act::keep_correction));
  for_each_node([&](std::size_t i) {
    restore(velocity_[i], unfiltered_[i]);
    if (keeps_constraints_) restore(constrained_[i], unfiltered_constrained_[i]);
  });
}

/// Adds the filter's correction, v+ <- v+ + (filtered v- minus v-), under the conditions and contact of v+.
void ReferenceBackend::add_correction(const Pass& pass, const StepInfo& step) {
  for_each_node([&](std::size_t i) {
    velocity_[i] += unfiltered_[i];
    if (records_ && mass_[i] > 0) filter_impulse_[i] += mass_[i] * unfiltered_[i];
    if (keeps_constraints_) constrained_[i] += unfiltered_constrained_[i];
  });
  impulse_.add_correction();
  reactions_.add_correction();
  constrain_free_velocity(pass, step);
  grid_.fill_velocity_ghosts(time_of(pass, step));
  for_each_node([&](std::size_t i) { momentum_[i] = mass_[i] * velocity_[i]; });
  if (records_) book_filter();
  record_reactions(step);
}

/// Applies conditions and contact to the velocity without what they have added so far.
void ReferenceBackend::constrain_free_velocity(const Pass& pass, const StepInfo& step) {
  if (!keeps_constraints_) return constrain_velocity(pass, step);
  if (notes_reactions_) reactions_.take_back();
  for_each_node([&](std::size_t i) {
    if (mass_[i] <= 0) return;
    if (records_) take_back(i);
    constrained_[i] = velocity_[i] -= constrained_[i];  // the free velocity, until they have acted
  });
  constrain_velocity(pass, step);
  for_each_node([&](std::size_t i) {
    if (mass_[i] > 0) constrained_[i] = velocity_[i] - constrained_[i];
  });
}

/// Applies conditions, contact and conditions again, as after the forces, but to velocities; of the record, the force alone changes.
void ReferenceBackend::constrain_velocity(const Pass& pass, const StepInfo& step) {
  const double time = time_of(pass, step);
  grid_.hold_grips_at_end(pass.stage != Stage::before_forces);
  impose_on_velocity(time);
  if (!plan_.resolves_contact()) return;
  law_stage_ = pass.stage == Stage::after_forces ? MPM_AFTER_FORCES : MPM_BEFORE_FORCES;
  const ContactGiven given = resolve_contact_of_velocity(time, step);
  if (!pass.remap()) impulse_.in_filter(given, keeps_constraints_, ledger_to_book());
  if (pass.stage == Stage::after_forces) record_force(step);
  impose_on_velocity(time);
}

void ReferenceBackend::impose_on_velocity(double time) {
  for_each_node([&](std::size_t i) {
    if (mass_[i] <= 0) return;
    const Vector before = velocity_[i];
    const std::vector<Held> all = grid_.held(i, before, time);
    for (const Held& held : all) velocity_[i][held.component] = held.velocity;
    note_held(all, i, mass_[i] * (velocity_[i] - before));
    if (!all.empty()) record(boundary_impulse_, standing_boundary_impulse_, i, mass_[i] * (velocity_[i] - before));
  });
}

}  // namespace mpm::reference
