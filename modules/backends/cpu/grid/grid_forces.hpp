#pragma once
// This part of GridStep works on all nodes: it makes velocities of momenta, applies forces, and orders the step.

#include <algorithm>

#include "backends/cpu/grid/grid_step.hpp"

namespace mpm::cpu {

template <int D, class T>
GridStep<D, T>::GridStep(const Scene<D, T>& scene, Grid<D, T>& grid, Ledger& ledger, HeatLedger& heat_ledger,
                         ContactRecord& record, FilterRecord& filter, ReactionImpulse& reactions)
    : NamedChannels{scene.plan},
      scene_(scene),
      grid_(grid),
      ledger_(ledger),
      heat_ledger_(heat_ledger),
      record_(record),
      impulse_(scene.experiment),
      filter_(filter),
      reactions_(reactions),
      pair_geometry_(scene.experiment, MPM_LANES_DOUBLE),
      own_normals_(scene.experiment.contact_normal &&
                   (scene.experiment.contact_normal->plugin->normal().traits & MPM_OWN_NORMALS)),
      edges_(scene.experiment.rigid_bodies.empty() ? std::vector<EdgeModel>() : edge_models(scene.experiment)),
      rigid_(scene.experiment),
      contact_points_(scene.experiment),
      wall_weights_(scene.plan.node_field("heated_volume") ? wall_weights(scene.experiment) : WallWeights()) {
  for (int c = 0; c < D; ++c) has_gravity_ = has_gravity_ || scene.experiment.has_gravity(c);
  take_gravity(0);
  keeps_before_conditions_ = scene.experiment.separates() &&
                             (!scene.experiment.boxes.empty() || scene.experiment.any_face(ConditionType::stick) ||
                              scene.experiment.any_face(ConditionType::prescribed));
  for (std::size_t k = 0; k < scene.experiment.grips.size(); ++k)
    grip_channels_.push_back(channel_of(scene.plan, grip_field(k)));
  for (Channel c = 0; c < grid.channels(); ++c) {
    folded_[static_cast<int>(grid.field(c).folded)].push_back(c);
    if (grid.field(c).at_wall == AtWall::slip) slipping_.push_back(c);
  }
  may_merge_ = scene.plan.divides_with_forces();
  if (const Pass* const strain = scene.plan.pass_of(Act::strain); strain && strain->stage == Stage::before_forces)
    early_share_ = strain->share;
}

/// Sets gravity to that of the step that begins at a time, s.
template <int D, class T>
void GridStep<D, T>::take_gravity(double time) {
  const Vector3 gravity = scene_.experiment.gravity_at(time);
  for (int c = 0; c < D; ++c) {
    gravity_[c] = static_cast<T>(gravity[c]);
    if (!scene_.experiment.gravity_has_potential(c)) gravity_without_potential_[c] = gravity_[c];
  }
}

/// Calls visit(field, first node, partial sums) for every block of nodes that may have mass of a field.
template <int D, class T>
template <class Visit>
void GridStep<D, T>::for_each_block(Visit&& visit) {
  partials_.assign(std::size_t(partial_count) * grid_.slots() * grid_.fields(), 0.0);
  visit_blocks(visit);
}

/// Does the same, and goes on with the partial sums of the last for_each_block.
template <int D, class T>
template <class Visit>
void GridStep<D, T>::visit_blocks(Visit&& visit) {
  const std::size_t slots = grid_.slots();
  scene_.team->for_each(slots * grid_.fields(), [&](std::size_t i) {
    const int field = static_cast<int>(i / slots);
    if (grid_.may_have_mass(field, i % slots))
      visit(field, static_cast<std::uint32_t>(i % slots) * block_nodes, partials_.data() + partial_count * i);
  });
}

template <int D, class T>
double GridStep<D, T>::sum_partials(int which) const {
  double sum = 0;
  for (std::size_t i = which; i < partials_.size(); i += partial_count) sum += partials_[i];
  return sum;
}

/// Sums only nodes with mass, as folded ghosts have a velocity too.
template <int D, class T>
double GridStep<D, T>::kinetic_energy() {
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    const Q* const nodes = &motion_at(field, first);
    Wide squares{};
    for (int k = 0; k < block_nodes; ++k) {
      const Wide v = widen(nodes[k]);
      squares += twice_kinetic_energy(v, v[3] > 0 ? v[3] : 0.0);
    }
    partial[0] = 0.5 * sum_of_components(squares);
  });
  return sum_partials(0);
}

/// Sums that of the momenta on the nodes that folding changes.
template <int D, class T>
double GridStep<D, T>::kinetic_energy_of_edges() {
  double sum = 0;
  for (int field = 0; field < grid_.fields(); ++field)
    for (const std::uint32_t node : grid_.edge_nodes()) {
      const Wide momentum = widen(motion_at(field, node));
      if (momentum[3] > 0) sum += 0.5 * sum_of_components(momentum * momentum) / momentum[3];
    }
  return sum;
}

/// Sets the velocities of a block's nodes to change(first node of a pack, velocities, masses), zero without mass;
/// returns whether any node has some. It takes as many nodes at once as a register holds.
template <int D, class T>
template <class Change>
bool GridStep<D, T>::for_each_pack(Q* nodes, Change&& change) {
  bool heavy = false;
  for (int node = 0; node < block_nodes; node += L::width / 4) {
    const L old = pack_of(nodes + node), mass(pick<3, 3, 3, 3, T>(old.v, old.v));
    const auto has_mass = mass > T(0);
    L velocity(T(0));
    if (any_lane<T>(has_mass)) {
      heavy = true;
      velocity = select(has_mass, change(node, old, mass), velocity);
    }
    L(pick<0, 1, 2, 7, T>(velocity.v, old.v)).store(reinterpret_cast<T*>(nodes + node));
  }
  return heavy;
}

/// Makes velocities of momenta, also in velocity_before where that is kept; returns their energy where asked for.
template <int D, class T>
double GridStep<D, T>::divide_by_mass(bool keeps_before, bool accounted) {
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    Q* const nodes = &motion_at(field, first);
    const bool heavy = for_each_pack(nodes, [](int, L momentum, L mass) { return velocity_of(momentum, mass); });
    if (keeps_before) std::memcpy(&grid_.quad(velocity_before, field, first), nodes, block_nodes * sizeof(Q));
    if (!accounted || !heavy) return;
    Wide squares{};
    for (int k = 0; k < block_nodes; ++k) {  // there is no velocity where there is no mass
      const Wide v = widen(nodes[k]);
      squares += twice_kinetic_energy(v, v[3]);
    }
    partial[0] = 0.5 * sum_of_components(squares);
  });
  return accounted ? sum_partials(0) : 0.0;
}

template <int D, class T>
void GridStep<D, T>::momentum_to_velocity(bool remap, const StepInfo& step) {
  const bool accounted = ledger_on() && !remap, keeps_before = !remap && grid_.has(velocity_before);
  if (!remap && scene_.experiment.changing_gravity) take_gravity(step.time);
  begin_stage(accounted);
  notes_reactions_ = reactions_.asked() && !remap;
  if (notes_reactions_) reactions_.begin_step();
  if (!remap) rigid_.begin_step();
  if (accounted) book_scattered_sums();
  fold_images(remap, step);
  const double edges_raw = accounted ? kinetic_energy_of_edges() : 0.0;
  fold_walls(remap, step);
  if (!scene_.experiment.grips.empty()) find_gripped_nodes();
  grips_at_end_ = remap;
  if (merges() && !remap) return;
  const double folded = accounted ? kinetic_energy_of_edges() - edges_raw : 0.0;
  const double energy = divide_by_mass(keeps_before, accounted);
  if (accounted) {
    scattered_energy_ = energy - folded;
    ledger_.scatter += scattered_energy_ - particles_.kinetic_energy;
    works_ = 0;
    book(&Ledger::boundary, work_of_folds_);
  }
  keep_free_velocity(false);
  impose(step.time);
  if (scene_.plan.resolves_contact()) {
    resolve_contact(step, remap ? Recorded::remap : Recorded::before_forces, Stage::before_forces, step.time);
    impose(step.time);
  }
  measure_constraints();
  if (notes_reactions_) reactions_.keep_before();
  if (keeps_before) copy_constrained_velocity();
  if (accounted) book_impulses();
  fill_ghosts(step.time, false);
}

/// Marks the slots where a condition or contact may change a velocity.
template <int D, class T>
void GridStep<D, T>::find_constrained_slots() {
  constrained_.assign(grid_.slots(), scene_.experiment.damping.acts());  // which concerns all of them
  if (scene_.experiment.damping.acts()) return;
  for (const FaceNodes& face : grid_.faces())
    for (const std::uint32_t node : face.wall) constrained_[node / block_nodes] = 1;
  for (const BoxNodes& box : grid_.boxes())
    for (const std::uint32_t node : box.nodes) constrained_[node / block_nodes] = 1;
  for (const GrippedNode& gripped : gripped_) constrained_[gripped.node / block_nodes] = 1;
  if (!scene_.plan.resolves_contact()) return;
  for (const std::uint32_t slot : grid_.shared_slots()) constrained_[slot] = 1;
  for (std::size_t body = 0; body < rigid_.count(); ++body)
    for (const RigidNode& near : rigid_.nodes(body))
      if (const std::int32_t node = grid_.find(near.at); node >= 0)
        constrained_[static_cast<std::uint32_t>(node) / block_nodes] = 1;
}

/// Copies into velocity_before what conditions and contact have changed since divide_by_mass.
template <int D, class T>
void GridStep<D, T>::copy_constrained_velocity() {
  find_constrained_slots();
  for_each_block([&](int field, std::uint32_t first, double*) {
    if (constrained_[first / block_nodes])
      std::memcpy(&grid_.quad(velocity_before, field, first), &motion_at(field, first), block_nodes * sizeof(Q));
  });
}

/// Adds what separates a folded weight from the folded mass's weight, before the forces.
template <int D, class T>
void GridStep<D, T>::add_gravity_corrections(double dt) {
  const auto& nodes = grid_.edge_nodes();
  for (int field = 0; has_gravity_ && field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double* const correction = gravity_correction_.data() + (field * nodes.size() + i) * 4;
      if (std::all_of(correction, correction + D, [](double weight) { return weight == 0; })) continue;
      Q& v = motion_at(field, nodes[i]);
      if (!(v[3] > 0)) continue;
      const double step = dt / v[3];
      for (int c = 0; c < D; ++c) {
        if (grid_.has(force))
          grid_.quad(force, field, nodes[i])[c] += static_cast<T>(correction[c]);
        else
          v[c] += static_cast<T>(step * correction[c]);
        largest_ = std::max(largest_, std::abs(v[c]));
      }
    }
}

/// A correction as it was added to a force, N.
template <int D, class T>
double GridStep<D, T>::gravity_corrections_at(int field, std::size_t edge, int component) const {
  return static_cast<T>(gravity_correction_[(field * grid_.edge_nodes().size() + edge) * 4 + component]);
}

/// Moves the work of the corrections, which was counted as part of the force, to gravity.
template <int D, class T>
void GridStep<D, T>::account_gravity_corrections(double dt) {
  const auto& nodes = grid_.edge_nodes();
  for (int field = 0; has_gravity_ && field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Q v = motion_at(field, nodes[i]), before = grid_.quad(velocity_before, field, nodes[i]);
      if (!(v[3] > 0)) continue;
      for (int c = 0; c < D; ++c) {
        const double work = 0.5 * dt * gravity_corrections_at(field, i, c) * (static_cast<double>(before[c]) + v[c]);
        ledger_.internal_force -= work;
        (scene_.experiment.gravity_has_potential(c) ? ledger_.gravity : ledger_.gravity_without_potential) += work;
      }
    }
}

/// Counts the work of the forces, and of the impulses of conditions and contact where there are any, between v- and v+
/// at their mean, and the energy of v+. Without mass there is no velocity, before or after.
template <int D, class T>
void GridStep<D, T>::account_for_block(int field, std::uint32_t first, double dt, bool with_impulses, double* partial) {
  const Q *const after = &motion_at(field, first), *const before = &grid_.quad(velocity_before, field, first),
                 *const forces = &grid_.quad(force, field, first);
  const Wide gravity = widen(gravity_);
  const Q* const walls =
      with_impulses && grid_.has(boundary_impulse) ? &grid_.quad(boundary_impulse, field, first) : nullptr;
  const Q* const pairs =
      with_impulses && grid_.has(contact_impulse) ? &grid_.quad(contact_impulse, field, first) : nullptr;
  const Q* const damping =
      with_impulses && grid_.has(damping_impulse) ? &grid_.quad(damping_impulse, field, first) : nullptr;
  Wide internal{}, momentum{}, squares{}, boundary{}, contact{}, lost{};
  for (int k = 0; k < block_nodes; ++k) {
    const Wide v = widen(after[k]), old = widen(before[k]), f = widen(forces[k]), mean = mean_velocity(old, v);
    const double mass = v[3];
    internal += f * mean;
    momentum += mass * mean;
    squares += twice_kinetic_energy(v, mass);
    if (walls) boundary += widen(walls[k]) * mean;
    if (pairs) contact += widen(pairs[k]) * mean;
    if (damping) lost += widen(damping[k]) * mean;
  }
  partial[of_internal_force] += dt * sum_of_components(internal);
  for (const ExternalChannel& load : external) {
    const Q* const given = &grid_.quad(load.channel, field, first);
    Wide work{};
    for (int k = 0; k < block_nodes; ++k) work += widen(given[k]) * mean_velocity(widen(before[k]), widen(after[k]));
    partial[of_external + static_cast<int>(load.kind)] += dt * sum_of_components(work);
  }
  const Wide periodic = widen(gravity_without_potential_);
  partial[of_gravity] += dt * sum_of_components(momentum * (gravity - periodic));
  partial[of_gravity_without_potential] += dt * sum_of_components(momentum * periodic);
  partial[of_boundary] += sum_of_components(boundary);
  partial[of_contact] += sum_of_components(contact);
  partial[of_damping] += sum_of_components(lost);
  partial[of_motion] += 0.5 * sum_of_components(squares);
}

/// After conditions and contact, counts the blocks that accelerate has left to them, and adds up the sums of all.
template <int D, class T>
void GridStep<D, T>::account_for_impulses(double dt) {
  visit_blocks([&](int field, std::uint32_t first, double* partial) {
    if (constrained_[first / block_nodes]) account_for_block(field, first, dt, true, partial);
  });
  book(&Ledger::internal_force, sum_partials(of_internal_force));
  for (const ExternalChannel& load : external)
    book(row_of(load.kind), sum_partials(of_external + static_cast<int>(load.kind)));
  book(&Ledger::gravity, sum_partials(of_gravity));
  book(&Ledger::gravity_without_potential, sum_partials(of_gravity_without_potential));
  book(&Ledger::boundary, sum_partials(of_boundary));
  book(&Ledger::contact, sum_partials(of_contact));
  book(&Ledger::damping, sum_partials(of_damping));
  kinetic_energy_after_ = sum_partials(of_motion);
  account_gravity_corrections(dt);
  if (scene_.plan.filters() || scene_.experiment.solver.stress_update == StressUpdate::modified_last)
    lumped_power_ = power_of_forces(dt);
  if (scene_.plan.filters() && has_gravity_) lumped_lift_ = power_of_weight(dt);
}

/// Applies the forces, and counts the blocks that neither condition nor contact concerns while they are in the cache.
template <int D, class T>
void GridStep<D, T>::accelerate(double dt) {
  const T step = static_cast<T>(dt);
  if (ledger_on()) find_constrained_slots();
  L gravity;
  for (int lane = 0; lane < L::width; ++lane) gravity.v[lane] = gravity_[lane % 4];
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    Q* const nodes = &motion_at(field, first);
    const Q* const f = grid_.has(force) ? &grid_.quad(force, field, first) : nullptr;
    const Q* loads[external_force_count];
    int count = 0;
    for (const ExternalChannel& load : external)
      if (grid_.has(load.channel)) loads[count++] = &grid_.quad(load.channel, field, first);
    const bool heavy = for_each_pack(nodes, [&](int node, L velocity, L mass) {
      if (!f && count == 0) return velocity + step * gravity;
      L total(T(0));
      if (f) total = total + pack_of(f + node);
      for (int k = 0; k < count; ++k) total = total + pack_of(loads[k] + node);
      return accelerated(velocity, total, mass, gravity, step);
    });
    if (ledger_on() && heavy && !constrained_[first / block_nodes]) account_for_block(field, first, dt, false, partial);
  });
}

/// Damps what the forces, conditions and contact have made of the velocity; conditions hold what they held.
template <int D, class T>
void GridStep<D, T>::damp(const StepInfo& step) {
  const Damping& damping = scene_.experiment.damping;
  const T local = static_cast<T>(damping.local), of_velocity = static_cast<T>(damping.left_of_velocity(step.dt)),
          of_change = static_cast<T>(damping.left_of_change(step.dt));
  visit_blocks([&](int field, std::uint32_t first, double*) {
    for (std::uint32_t node = first; node < first + block_nodes; ++node) {
      Q& v = motion_at(field, node);
      const Q before = grid_.quad(velocity_before, field, node);
      for (int c = 0; c < D && v[3] > 0; ++c) {
        const T now = damped<T>(before[c], v[c], local, of_velocity, of_change);
        if (records_) grid_.quad(damping_impulse, field, node)[c] += v[3] * (now - v[c]);
        v[c] = now;
      }
    }
  });
  keep_free_velocity(true);
  impose(step.time + step.dt);
  measure_constraints();
}

/// Makes velocities of momenta and applies gravity in one pass; forces came with the momenta.
template <int D, class T>
void GridStep<D, T>::divide_and_accelerate(double dt) {
  L change;
  for (int lane = 0; lane < L::width; ++lane) change.v[lane] = static_cast<T>(dt) * gravity_[lane % 4];
  largest_ = scene_.team->template largest<T>(std::size_t(grid_.slots()) * grid_.fields(), [&](std::size_t i) {
    L largest(T(0));
    for_each_pack(&motion_at(0, 0) + i * block_nodes, [&](int, L momentum, L mass) {
      const L velocity = velocity_of(momentum, mass) + change;
      largest = max(largest, select(mass > T(0), abs(velocity), L(T(0))));
      return velocity;
    });
    T fastest = 0;
    for (int lane = 0; lane < L::width; ++lane)
      if (lane % 4 < D) fastest = std::max(fastest, largest.v[lane]);
    return fastest;
  });
}

/// Includes what walls, boxes and ghosts have given since; those that stand still give nothing larger than there was.
template <int D, class T>
void GridStep<D, T>::extend_largest_by_edges() {
  bool moving = false;
  for (const FaceNodes& face : grid_.faces()) moving = moving || face.condition->velocity;
  for (const BoxNodes& box : grid_.boxes()) moving = moving || box.condition->velocity;
  if (!moving) return;
  const auto extend = [&](std::uint32_t node) {
    for (int field = 0; field < grid_.fields(); ++field)
      for (int c = 0; c < D; ++c) largest_ = std::max(largest_, std::abs(motion_at(field, node)[c]));
  };
  for (const std::uint32_t node : grid_.edge_nodes()) extend(node);
  for (const FaceNodes& face : grid_.faces())
    for (const std::uint32_t node : face.wall) extend(node);
  for (const BoxNodes& box : grid_.boxes())
    for (const std::uint32_t node : box.nodes) extend(node);
}

template <int D, class T>
void GridStep<D, T>::subtract_velocity_before() {
  for_each_block([&](int field, std::uint32_t first, double*) {
    const Q* const after = &motion_at(field, first);
    Q* const before = &grid_.quad(velocity_before, field, first);
    for (int k = 0; k < block_nodes; ++k) before[k] = after[k] - before[k];
  });
}

template <int D, class T>
void GridStep<D, T>::apply_forces(const StepInfo& step) {
  const double end = step.time + step.dt;
  notes_reactions_ = reactions_.asked();
  grips_at_end_ = true;
  if (merges()) {
    divide_and_accelerate(step.dt);
    add_gravity_corrections(step.dt);
    impose(end);
    fill_ghosts(end, false);
    record_reactions(step, false);
    return extend_largest_by_edges();
  }
  for (const bool periodic : {true, false})
    fold_forces(periodic, end, step.dt);  // folds those that USF scattered after the momenta
  add_gravity_corrections(step.dt);
  accelerate(step.dt);
  begin_stage(ledger_on());
  keep_free_velocity(true);
  impose(end);
  if (scene_.plan.resolves_contact()) {
    resolve_contact(step, Recorded::after_forces, Stage::after_forces, end);
    impose(end);
  }
  measure_constraints();
  if (scene_.experiment.damping.acts()) damp(step);
  if (ledger_on()) account_for_impulses(step.dt);
  const bool gathers_increment = scene_.has(MPM_GATHERS_INCREMENT);
  if (gathers_increment) subtract_velocity_before();
  fill_ghosts(end, gathers_increment);
  record_reactions(step, gathers_increment);
  rigid_.end_step(step);
}

}  // namespace mpm::cpu
