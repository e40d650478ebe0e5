#pragma once
// GridStep over all nodes: momenta to velocities, forces, and the order of a step.

#include "grid_step.hpp"

namespace mpm::cpu {

template <int D, class T>
GridStep<D, T>::GridStep(const Scene<D, T>& scene, Grid<D, T>& grid, Ledger& ledger, ContactRecord& record,
                         FilterRecord& filter)
    : scene_(scene), grid_(grid), ledger_(ledger), record_(record), filter_(filter) {
  for (int c = 0; c < D; ++c) {
    gravity_[c] = static_cast<T>(scene.experiment.gravity[c]);
    has_gravity_ = has_gravity_ || gravity_[c] != 0;
  }
  if (scene.plan.contact)
    for (int field = 0; field < scene.experiment.field_count; ++field)
      edges_.emplace_back(scene.experiment.shape, rows_per_cell(scene.experiment, field));
}

/// Calls visit(field, first node, partial sums) for every block of nodes of every field.
template <int D, class T>
template <class Visit>
void GridStep<D, T>::for_each_block(Visit&& visit) {
  const std::int64_t slots = grid_.slots(), blocks = slots * grid_.fields();
  partials_.assign(partial_count * blocks, 0.0);
#pragma omp parallel for num_threads(scene_.threads) schedule(static)
  for (std::int64_t i = 0; i < blocks; ++i)
    visit(static_cast<int>(i / slots), static_cast<std::uint32_t>(i % slots) * block_nodes,
          partials_.data() + partial_count * i);
}

template <int D, class T>
double GridStep<D, T>::sum_partials(int which) const {
  double sum = 0;
  for (std::size_t i = which; i < partials_.size(); i += partial_count) sum += partials_[i];
  return sum;
}

template <int D, class T>
double GridStep<D, T>::kinetic_energy(bool of_momenta) {
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    for (std::uint32_t node = first; node < first + block_nodes; ++node) {
      const Q value = motion_at(field, node);
      const double mass = value[3];
      double square = 0;
      for (int c = 0; c < D; ++c) square += static_cast<double>(value[c]) * value[c];
      if (mass > 0) partial[0] += 0.5 * (of_momenta ? square / mass : square * mass);
    }
  });
  return sum_partials(0);
}

template <int D, class T>
void GridStep<D, T>::divide_by_mass() {
  for_each_block([&](int field, std::uint32_t first, double*) {
    Q* const nodes = &motion_at(field, first);
    for (int k = 0; k < block_nodes; ++k) {
      const T mass = nodes[k][3];
      const Q mass4 = mass - Q{};
      Q velocity = mass > 0 ? nodes[k] / mass4 : Q{};
      velocity[3] = mass;
      nodes[k] = velocity;
    }
  });
}

template <int D, class T>
void GridStep<D, T>::momentum_to_velocity(bool remap, const StepInfo& step) {
  const bool accounted = ledger_on() && !remap;
  fold_images(remap, step);
  const double raw = accounted ? kinetic_energy(true) : 0.0;
  if (accounted) ledger_.scatter += raw - particle_kinetic_energy_;
  fold_walls(remap, step);
  if (accounted) ledger_.boundary += kinetic_energy(true) - raw;

  divide_by_mass();
  const Account account = accounted ? Account::change_of_energy : Account::nothing;
  impose(step.time, account);
  if (scene_.plan.contact) {
    resolve_contact(step, remap ? Recorded::remap : Recorded::before_forces);
    impose(step.time, account);
  }
  if (!remap && grid_.has(velocity_before)) copy_velocity(motion, velocity_before);
  fill_ghosts(step.time, false);
}

/// What separates a folded weight from the folded mass's weight, before the forces.
template <int D, class T>
void GridStep<D, T>::add_gravity_corrections(double dt) {
  const auto& nodes = grid_.edge_nodes();
  for (int field = 0; has_gravity_ && field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double* const correction = gravity_correction_.data() + (field * nodes.size() + i) * 4;
      Q& v = motion_at(field, nodes[i]);
      if (!(v[3] > 0)) continue;
      for (int c = 0; c < D; ++c) {
        if (grid_.has(force))
          grid_.quad(force, field, nodes[i])[c] += static_cast<T>(correction[c]);
        else
          v[c] += static_cast<T>(dt * correction[c] / v[3]);
      }
    }
}

/// The corrections worked as part of the force; they belong to gravity.
template <int D, class T>
void GridStep<D, T>::account_gravity_corrections(double dt) {
  const auto& nodes = grid_.edge_nodes();
  for (int field = 0; has_gravity_ && field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Q v = motion_at(field, nodes[i]), before = grid_.quad(velocity_before, field, nodes[i]);
      if (!(v[3] > 0)) continue;
      for (int c = 0; c < D; ++c) {
        const double correction = static_cast<T>(gravity_correction_[(field * nodes.size() + i) * 4 + c]);
        const double work = 0.5 * dt * correction * (static_cast<double>(before[c]) + v[c]);
        ledger_.internal_force -= work;
        ledger_.gravity += work;
      }
    }
}

/// Work of every impulse between v- and v+ at their mean. What the forces do not explain is the reaction of a condition
/// on held components and of contact on the others.
template <int D, class T>
void GridStep<D, T>::account_for_node(int field, std::uint32_t node, double dt, double* partial) {
  const Q v = motion_at(field, node), before = grid_.quad(velocity_before, field, node);
  const double mass = v[3];
  if (!(mass > 0)) return;
  const std::uint8_t held = held_[std::size_t(field) * grid_.nodes() + node];
  for (int c = 0; c < D; ++c) {
    const double f = grid_.quad(force, field, node)[c];
    const double body = grid_.has(body_force) ? grid_.quad(body_force, field, node)[c] : T(0);
    const double weight = mass * gravity_[c];
    const double mean = 0.5 * (static_cast<double>(before[c]) + v[c]);
    partial[0] += dt * f * mean;
    partial[1] += dt * body * mean;
    partial[2] += dt * weight * mean;
    const double reaction = mass * (static_cast<double>(v[c]) - before[c]) - dt * (f + body + weight);
    if (held & (1u << c))
      partial[3] += reaction * mean;
    else if (scene_.plan.contact)
      partial[4] += reaction * mean;
  }
}

template <int D, class T>
void GridStep<D, T>::account_for_impulses(double dt) {
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    for (int k = 0; k < block_nodes; ++k) account_for_node(field, first + k, dt, partial);
  });
  ledger_.internal_force += sum_partials(0);
  ledger_.body_force += sum_partials(1);
  ledger_.gravity += sum_partials(2);
  ledger_.boundary += sum_partials(3);
  ledger_.contact += sum_partials(4);
  account_gravity_corrections(dt);
}

template <int D, class T>
void GridStep<D, T>::accelerate(double dt) {
  const T step = static_cast<T>(dt);
  for_each_block([&](int field, std::uint32_t first, double*) {
    Q* const nodes = &motion_at(field, first);
    const Q* const f = grid_.has(force) ? &grid_.quad(force, field, first) : nullptr;
    const Q* const body = grid_.has(body_force) ? &grid_.quad(body_force, field, first) : nullptr;
    for (int k = 0; k < block_nodes; ++k) {
      const T mass = nodes[k][3];
      Q total{};
      if (f) total += f[k];
      if (body) total += body[k];
      Q velocity = mass > 0 ? nodes[k] + step * (total / mass + gravity_) : Q{};
      velocity[3] = mass;
      nodes[k] = velocity;
    }
  });
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
  for (const bool periodic : {true, false}) fold_forces(periodic);  // those that USF scattered after the momenta
  add_gravity_corrections(step.dt);
  accelerate(step.dt);
  const Account account = ledger_on() ? Account::mark : Account::nothing;
  if (ledger_on()) held_.assign(std::size_t(grid_.fields()) * grid_.nodes(), 0);
  impose(end, account);
  if (scene_.plan.contact) {
    resolve_contact(step, Recorded::after_forces);
    impose(end, account);
  }
  if (ledger_on()) {
    account_for_impulses(step.dt);
    kinetic_energy_after_ = kinetic_energy(false);
  }
  if (scene_.plan.velocity_increment) subtract_velocity_before();
  fill_ghosts(end, scene_.plan.velocity_increment);
}

}  // namespace mpm::cpu
