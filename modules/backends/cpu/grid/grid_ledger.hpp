#pragma once
// This part of GridStep keeps the energy ledger: whoever gives a node an impulse notes it, and at the end of each stage
// of the step (before the forces, after them, in a filter) the works of these are booked.

#include <algorithm>
#include <cmath>

#include "backends/cpu/grid/grid_step.hpp"

namespace mpm::cpu {

/// Clears the impulses of the stage before.
template <int D, class T>
void GridStep<D, T>::begin_stage(bool records) {
  records_ = records;
  work_of_folds_ = 0;
  if (!records) return;
  for (const Channel c : {boundary_impulse, contact_impulse, filter_impulse, damping_impulse})
    if (grid_.has(c)) grid_.clear(c);
}

/// Notes an impulse on a component of a node where conditions or contact apply it.
template <int D, class T>
void GridStep<D, T>::record(Channel impulse, Channel standing, int field, std::uint32_t node, int c, double given) {
  grid_.quad(impulse, field, node)[c] += static_cast<T>(given);
  if (grid_.has(standing)) grid_.quad(standing, field, node)[c] += static_cast<T>(given);
}

/// Notes that a filter's loop takes back what conditions and contact have given the nodes of a block so far. The rest
/// of `constrained` came with the filter's correction.
template <int D, class T>
void GridStep<D, T>::take_back(int field, std::uint32_t first) {
  for (std::uint32_t node = first; node < first + block_nodes; ++node) {
    const Q v = motion_at(field, node);
    if (!(v[3] > 0)) continue;
    Q of_filter = v[3] * grid_.quad(constrained, field, node);
    for (const auto& [impulse, standing] :
         {std::pair{boundary_impulse, standing_boundary}, std::pair{contact_impulse, standing_contact}}) {
      if (!grid_.has(standing)) continue;
      Q& taken = grid_.quad(standing, field, node);
      grid_.quad(impulse, field, node) -= taken;
      of_filter -= taken;
      taken = Q{};
    }
    grid_.quad(filter_impulse, field, node) -= of_filter;
  }
}

/// Books a work on the nodes.
template <int D, class T>
void GridStep<D, T>::book(double Ledger::*row, double work) {
  ledger_.*row += work;
  works_ += work;
}

/// Compares what the particles have with what the nodes were given.
template <int D, class T>
void GridStep<D, T>::book_scattered_sums() {
  for (const Channel c : {standing_boundary, standing_contact})
    if (grid_.has(c)) grid_.clear(c);
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    Wide sum{};
    for (int k = 0; k < block_nodes; ++k) sum += widen(motion_at(field, first + k));
    for (int c = 0; c < 4; ++c) partial[c] = sum[c];
  });
  ledger_.mass_book += particles_.mass - sum_partials(3);
  double squares = 0;
  for (int c = 0; c < D; ++c) {
    const double lost = particles_.momentum[c] - sum_partials(c);
    squares += lost * lost;
  }
  ledger_.momentum_book += std::sqrt(squares);
}

/// Books the works of the stage's impulses at the mean of the velocities before and after them.
template <int D, class T>
void GridStep<D, T>::book_impulses() {
  const std::pair<Channel, Partial> impulses[] = {
      {boundary_impulse, of_boundary}, {contact_impulse, of_contact}, {filter_impulse, of_filter}};
  if (std::none_of(std::begin(impulses), std::end(impulses), [&](const auto& row) { return grid_.has(row.first); }))
    return;
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    for (std::uint32_t node = first; node < first + block_nodes; ++node) {
      const Wide v = widen(motion_at(field, node));
      if (!(v[3] > 0)) continue;
      Wide all{};
      for (const auto& [impulse, row] : impulses)
        if (grid_.has(impulse)) all += widen(grid_.quad(impulse, field, node));
      const Wide mean = v - all / (2 * v[3]);
      for (const auto& [impulse, row] : impulses)
        if (grid_.has(impulse)) partial[row] += sum_of_components(widen(grid_.quad(impulse, field, node)) * mean);
    }
  });
  book(&Ledger::boundary, sum_partials(of_boundary));
  book(&Ledger::contact, sum_partials(of_contact));
  book(&Ledger::filter, sum_partials(of_filter));
}

/// Books the works of a filter's loop, and what they do not explain of the kinetic energy.
template <int D, class T>
void GridStep<D, T>::book_filter() {
  const double works = works_, before = kinetic_energy_after_;
  book_impulses();
  kinetic_energy_after_ = kinetic_energy();
  ledger_.filter_book += kinetic_energy_after_ - before - (works_ - works);
  works_ = works + kinetic_energy_after_ - before;
}

/// The work of the stresses' forces at the velocity of the nodes as it is now, J.
template <int D, class T>
double GridStep<D, T>::power_of_forces(double dt) {
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    Wide sum{};
    for (std::uint32_t node = first; node < first + block_nodes; ++node)
      if (motion_at(field, node)[3] > 0) sum += widen(motion_at(field, node)) * widen(grid_.quad(force, field, node));
    partial[0] = dt * sum_of_components(sum);
  });
  double power = sum_partials(0);
  const auto& nodes = grid_.edge_nodes();  // their forces hold a part of the weight
  for (int field = 0; has_gravity_ && field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Q v = motion_at(field, nodes[i]);
      for (int c = 0; c < D && v[3] > 0; ++c) power -= dt * gravity_corrections_at(field, i, c) * double(v[c]);
    }
  return power;
}

/// The work of gravity, where it has a potential, at the velocity of the nodes as it is now, J.
template <int D, class T>
double GridStep<D, T>::power_of_weight(double dt) {
  const Wide gravity = widen(gravity_) - widen(gravity_without_potential_);
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    Wide sum{};
    for (std::uint32_t node = first; node < first + block_nodes; ++node) {
      const Wide v = widen(motion_at(field, node));
      sum += v[3] * v;
    }
    partial[0] = dt * sum_of_components(sum * gravity);
  });
  double power = sum_partials(0);
  const auto& nodes = grid_.edge_nodes();
  for (int field = 0; has_gravity_ && field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Q v = motion_at(field, nodes[i]);
      for (int c = 0; c < D && v[3] > 0; ++c)
        if (scene_.experiment.gravity_has_potential(c))
          power += dt * gravity_corrections_at(field, i, c) * double(v[c]);
    }
  return power;
}

/// Books what particles that the filtered velocity moves gain less of potential energy than v+ would give them.
template <int D, class T>
void GridStep<D, T>::book_filtered_gravity(double dt) {
  if (has_gravity_) ledger_.filtered_gravity -= power_of_weight(dt) - lumped_lift_;
}

template <int D, class T>
void GridStep<D, T>::book_gather(double kinetic_energy) {
  ledger_.gather += kinetic_energy - kinetic_energy_after_;
  ledger_.grid_book += kinetic_energy_after_ - scattered_energy_ - works_;
}

template <int D, class T>
void GridStep<D, T>::book_strain(double Ledger::*row, double share, double dt) {
  ledger_.*row -= share * (power_of_forces(dt) - lumped_power_);
}

/// Books what strain before the forces stored less by the filtered velocity, the one of now, than by the one kept
/// aside. Neither forces nor velocities are folded yet, so that ghosts count.
template <int D, class T>
void GridStep<D, T>::book_filtered_strain(double dt) {
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    Wide sum{};
    for (std::uint32_t node = first; node < first + block_nodes; ++node)
      sum += widen(grid_.quad(force, field, node)) *
             (widen(motion_at(field, node)) - widen(grid_.quad(kept_velocity, field, node)));
    partial[0] = dt * sum_of_components(sum);
  });
  ledger_.filtered_strain -= early_share_ * sum_partials(0);
}

}  // namespace mpm::cpu
