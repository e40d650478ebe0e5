#pragma once
// This part of GridStep is the loop of a filter over the nodes (abi.h, mpm_filter). Ghosts have no mass while their
// mirrors stand for them, so nodes with mass are the nodes that count.

#include <limits>

#include "backends/cpu/grid/grid_step.hpp"

namespace mpm::cpu {

template <int D, class T>
void GridStep<D, T>::copy_velocity(Channel from, Channel to) {
  for_each_block([&](int field, std::uint32_t first, double*) {
    std::memcpy(&grid_.quad(to, field, first), &grid_.quad(from, field, first), block_nodes * sizeof(Q));
  });
}

/// The norm sqrt(sum m v*.v*), summed block after block whatever the number of threads.
template <int D, class T>
double GridStep<D, T>::mass_norm_of_increment() {
  for_each_block([&](int field, std::uint32_t first, double* partial) {
    for (std::uint32_t node = first; node < first + block_nodes; ++node) {
      const double mass = motion_at(field, node)[3];
      if (!(mass > 0)) continue;
      const Q v = grid_.quad(filter_increment, field, node);
      for (int c = 0; c < D; ++c) partial[0] += mass_norm_term(mass, static_cast<double>(v[c]));
    }
  });
  return std::sqrt(sum_partials(0));
}

template <int D, class T>
void GridStep<D, T>::begin_filter(const Pass& pass) {
  begin_stage(ledger_on() && pass.stage == Stage::after_forces);
  copy_velocity(motion, filter_increment);
  if (pass.stage == Stage::before_forces) copy_velocity(motion, kept_velocity);
  if (pass.stage == Stage::before_forces && grid_.has(constrained)) copy_velocity(constrained, kept_constrained);
  if (pass.stage == Stage::before_forces) impulse_.keep(), reactions_.keep();
  filter_.iterations = 0;
  filter_.first_norm = filter_.last_norm = mass_norm_of_increment();
}

/// Folds and divides the momenta that the particles scattered. The first increment is a velocity, which walls mirror
/// about their own; the later ones are differences.
template <int D, class T>
void GridStep<D, T>::project_increment(const Pass& pass, const StepInfo& step) {
  const double time = time_of(pass, step);
  const bool first = filter_.iterations == 0;
  if (notes_reactions_) reactions_.begin_projection();
  for (const FaceNodes& face : grid_.faces()) {  // images first, then walls, as fold_faces decided
    const Q signs = mirror_signs(face, AtWall::momentum);
    if (first) find_wall_velocities(face, time);
    for_each_folded(face, [&](int field, const MirrorPair& pair) {
      const Q wall = first ? wall_velocity(face, pair) : Q{};
      if (notes_reactions_ && !face.periodic())
        note_projection(face, static_cast<std::size_t>(&pair - face.pairs.data()), field, signs, wall);
      fold_momentum(filter_projection, field, pair, signs, wall);
    });
  }
  for_each_block([&](int field, std::uint32_t first, double*) {
    const Q* const nodes = &motion_at(field, first);
    Q* const projected = &grid_.quad(filter_projection, field, first);
    for (int k = 0; k < block_nodes; ++k) {
      const Q mass = nodes[k][3] - Q{};
      projected[k] = nodes[k][3] > 0 ? velocity_of(projected[k], mass) : Q{};
    }
  });
}

/// Calls the plugin on the nodes of one block that have mass.
template <int D, class T>
void GridStep<D, T>::update_block(int field, std::uint32_t first, std::uint32_t iteration) {
  alignas(64) T projected[D * block_nodes], increment[D * block_nodes], velocity[D * block_nodes];
  std::uint32_t node[block_nodes];
  int count = 0;
  for (std::uint32_t n = first; n < first + block_nodes; ++n) {
    const Q v = motion_at(field, n);
    if (!(v[3] > 0)) continue;
    const Q p = grid_.quad(filter_projection, field, n), i = grid_.quad(filter_increment, field, n);
    for (int c = 0; c < D; ++c) {
      projected[c * block_nodes + count] = p[c];
      increment[c * block_nodes + count] = i[c];
      velocity[c * block_nodes + count] = v[c];
    }
    node[count++] = n;
  }
  if (count == 0) return;
  const int end = padded(count);
  for (int i = count; i < end; ++i)
    for (T* const array : {projected, increment, velocity})
      for (int c = 0; c < D; ++c) array[c * block_nodes + i] = array[c * block_nodes + count - 1];
  const Component& filter = *scene_.experiment.filter;
  const mpm_filter_batch batch{
      static_cast<std::uint32_t>(end), block_nodes, D, iteration, projected, increment, velocity};
  filter.plugin->filter().update[lane_precision<T>][D - 2](filter.parameters.data(), &batch);
  for (int i = 0; i < count; ++i) {
    Q &v = motion_at(field, node[i]), &star = grid_.quad(filter_increment, field, node[i]);
    for (int c = 0; c < D; ++c) {
      const T now = velocity[c * block_nodes + i];
      if (records_) grid_.quad(filter_impulse, field, node[i])[c] += v[3] * (now - v[c]);
      v[c] = now;
      star[c] = increment[c * block_nodes + i];
    }
  }
}

/// Sets `constrained` to the velocity without what conditions and contact have added in this step.
template <int D, class T>
void GridStep<D, T>::keep_free_velocity(bool after_forces) {
  if (!grid_.has(constrained)) return;
  visit_blocks([&](int field, std::uint32_t first, double*) {  // this leaves the ledger's partial sums alone
    const Q* const nodes = &motion_at(field, first);
    Q* const added = &grid_.quad(constrained, field, first);
    for (int k = 0; k < block_nodes; ++k) added[k] = after_forces ? without(nodes[k], added[k]) : nodes[k];
  });
}

template <int D, class T>
void GridStep<D, T>::measure_constraints() {
  if (!grid_.has(constrained)) return;
  visit_blocks([&](int field, std::uint32_t first, double*) {
    const Q* const nodes = &motion_at(field, first);
    Q* const added = &grid_.quad(constrained, field, first);
    for (int k = 0; k < block_nodes; ++k) added[k] = without(nodes[k], added[k]);  // this leaves no mass in it
  });
}

/// Applies conditions and contact to the velocity without what they have added so far, so that an impulse which the
/// increments no longer need is taken back.
template <int D, class T>
void GridStep<D, T>::constrain_free(const Pass& pass, const StepInfo& step) {
  if (!grid_.has(constrained)) return constrain(pass, step);
  if (notes_reactions_) reactions_.take_back();
  for_each_block([&](int field, std::uint32_t first, double*) {
    Q *const nodes = &motion_at(field, first), *const added = &grid_.quad(constrained, field, first);
    if (records_) take_back(field, first);
    for (int k = 0; k < block_nodes; ++k) added[k] = nodes[k] = without(nodes[k], added[k]);
  });
  constrain(pass, step);
  measure_constraints();
}

/// Applies conditions and contact to the velocity as it is; of the records the contact force alone changes.
template <int D, class T>
void GridStep<D, T>::constrain(const Pass& pass, const StepInfo& step) {
  const double time = time_of(pass, step);
  grips_at_end_ = pass.stage != Stage::before_forces;
  impose(time);
  if (!scene_.plan.resolves_contact()) return;
  resolve_contact(step, pass.remap() ? Recorded::remap : Recorded::filter, pass.stage, time);
  if (pass.stage == Stage::after_forces) record_force(step);
  impose(time);
}

template <int D, class T>
void GridStep<D, T>::update_filter(const Pass& pass, const StepInfo& step) {
  const std::uint32_t iteration = static_cast<std::uint32_t>(filter_.iterations + 1);
  for_each_block([&](int field, std::uint32_t first, double*) { update_block(field, first, iteration); });
  if (notes_reactions_) reactions_.take_projection(static_cast<int>(iteration));
  if (scene_.experiment.filter_schedule.constrain_always) {
    copy_velocity(motion, filter_projection);
    constrain_free(pass, step);
    for_each_block([&](int field, std::uint32_t first, double*) {
      for (std::uint32_t node = first; node < first + block_nodes; ++node)
        if (motion_at(field, node)[3] > 0)
          grid_.quad(filter_increment, field, node) =
              corrected_increment(grid_.quad(filter_increment, field, node), motion_at(field, node),
                                  grid_.quad(filter_projection, field, node));
    });
  }
  filter_.take_norm(mass_norm_of_increment(), 4500.0 * static_cast<double>(std::numeric_limits<T>::epsilon()));

  // An increment is a difference of velocities: walls mirror it as if they were at rest.
  auto& faces = grid_.faces();
  for (auto face = faces.rbegin(); face != faces.rend(); ++face) {
    const Q signs = mirror_signs(*face, AtWall::vector);
    for_each_folded(*face, [&](int field, const MirrorPair& pair) {
      grid_.quad(filter_increment, field, pair.ghost) = signs * grid_.quad(filter_increment, field, pair.mirror);
    });
  }
}

template <int D, class T>
void GridStep<D, T>::end_filter(const Pass& pass, const StepInfo& step) {
  const double time = time_of(pass, step);
  if (!scene_.experiment.filter_schedule.constrain_always) constrain_free(pass, step);
  fill_ghosts(time, false);
  if (records_) book_filter();
  if (pass.stage == Stage::after_forces) record_reactions(step, false);
}

template <int D, class T>
void GridStep<D, T>::restore_velocity(const Pass& pass, const StepInfo& step) {
  if (ledger_on() && !pass.has(Act::keep_correction)) book_filtered_strain(step.dt);
  impulse_.restore(pass.has(Act::keep_correction));
  reactions_.restore(pass.has(Act::keep_correction));
  restore(motion, kept_velocity, pass.has(Act::keep_correction));
  if (grid_.has(constrained)) restore(constrained, kept_constrained, pass.has(Act::keep_correction));
}

template <int D, class T>
void GridStep<D, T>::restore(Channel channel, Channel kept_channel, bool keeps_correction) {
  if (!keeps_correction) return copy_velocity(kept_channel, channel);
  for_each_block([&](int field, std::uint32_t first, double*) {
    Q *const nodes = &grid_.quad(channel, field, first), *const kept = &grid_.quad(kept_channel, field, first);
    for (int k = 0; k < block_nodes; ++k) {
      const Q filtered = nodes[k];
      nodes[k] = kept[k];
      kept[k] = without(filtered, kept[k]);  // this leaves no mass in it
    }
  });
}

template <int D, class T>
void GridStep<D, T>::add(Channel correction, Channel channel) {
  for_each_block([&](int field, std::uint32_t first, double*) {
    Q* const nodes = &grid_.quad(channel, field, first);
    const Q* const added = &grid_.quad(correction, field, first);
    for (int k = 0; k < block_nodes; ++k) nodes[k] += added[k];
  });
}

/// Adds the filter's correction, v+ <- v+ + (filtered v- minus v-), under the conditions and contact of v+.
template <int D, class T>
void GridStep<D, T>::add_correction(const Pass& pass, const StepInfo& step) {
  begin_stage(ledger_on());
  if (records_)
    for_each_block([&](int field, std::uint32_t first, double*) {
      const Q *const nodes = &motion_at(field, first), *const added = &grid_.quad(kept_velocity, field, first);
      for (int k = 0; k < block_nodes; ++k) grid_.quad(filter_impulse, field, first + k) += nodes[k][3] * added[k];
    });
  add(kept_velocity, motion);
  if (grid_.has(constrained)) add(kept_constrained, constrained);
  impulse_.add_correction();
  reactions_.add_correction();
  constrain_free(pass, step);
  fill_ghosts(time_of(pass, step), false);
  if (records_) book_filter();
  record_reactions(step, false);
}

}  // namespace mpm::cpu
