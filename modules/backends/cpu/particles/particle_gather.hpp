#pragma once
// This part of ParticleStep takes the grid to the particles: gather, strain, movement and the time step's limit.

#include <cmath>

#include "backends/cpu/particles/particle_grips.hpp"
#include "backends/cpu/particles/particle_lists.hpp"
#include "kernel/lanes.hpp"
#include "operators/motion.hpp"

namespace mpm::cpu {

/// Copies what a block reaches of the velocities (and of what FLIP takes) into the thread's tiles.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::load_velocities(int body, const Block<D>& block, Work& work) {
  const int field = bodies_[body].field;
  kernels_.load(work.velocity_tile.data(), grid_.channel(motion, field), block.neighbours.data(), block.reach);
  if (scene_.has(MPM_GATHERS_INCREMENT))
    kernels_.load(work.increment_tile.data(), grid_.channel(velocity_before, field), block.neighbours.data(),
                  block.reach);
  work.clock.lap(Phase::tiles);
}

/// Copies what a block reaches of an average of the nodes into the thread's tile, where the scene has it.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::load_mean(int body, const Block<D>& block, Work& work, Channel channel) {
  if (channel < 0) return;
  kernels_.load(work.mean_tile.data(), grid_.channel(channel, bodies_[body].field), block.neighbours.data(),
                block.reach);
}

/// Adds the thread's tile of a channel to the grid.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::flush(int body, const Block<D>& block, Work& work, Channel channel) {
  work.clock.lap(Phase::other);
  kernels_.flush(work.tile[channel].data(), grid_.channel(channel, bodies_[body].field), block.neighbours.data(),
                 block.reach);
  work.clock.lap(Phase::tiles);
}

/// Adds the tiles of what a block has scattered.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::flush(int body, const Block<D>& block, Work& work,
                                           const std::vector<Channel>& channels) {
  for (const Channel c : channels)
    if (block.may_meet || !grid_.field(c).for_contact) flush(body, block, work, c);
}

/// Takes the drift as it was measured; else the sum of the largest moves bounds it.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::account_for_move() {
  Moved largest;
  for (const auto& work : work_) largest.extend(work->moved);
  last_drift_ = largest.distance;
  drift_ = measures_drift_ ? largest.outside : drift_ + last_drift_;
}

template <int D, class T, class Components>
typename ParticleStep<D, T, Components>::Gathered ParticleStep<D, T, Components>::sum_gathered(bool moved) {
  if (moved) account_for_move();
  failure_.raise();
  Gathered sum;
  if (!accounted_ && !scene_.plan.has_heat_ledger()) return sum;  // blocks lie with the threads that worked on them
  for (std::size_t body = 0; body < particles_.size(); ++body) {
    StrainEnergies strained;
    double phase_change = 0;
    for (const Block<D>& block : particles_[body].blocks) {
      sum.kinetic_energy += block.kinetic_energy;
      strained.add(block.strained);
      phase_change += block.phase_change;
      sum.heat += block.heat;
      sum.heat_of_dissipation += block.heat_of_dissipation;
    }
    sum.strained.enter_strain(bodies_[body].dissipation, strained);
    sum.strained.enter_phase_change(phase_change);
  }
  return sum;
}

template <int D, class T, class Components>
typename ParticleStep<D, T, Components>::Gathered ParticleStep<D, T, Components>::gather(const Pass& pass,
                                                                                         const StepInfo& step) {
  account_for(step);
  if (!grips_.empty()) clear_given_to_gripped();
  for (auto& work : work_) work->moved = {};
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      block.kinetic_energy = block.phase_change = block.heat_of_dissipation = 0;
      block.strained = {};
      if (pass.has(Act::gather_heat)) gather_heat(body, block, work, step);
      if (pass.has(Act::strain)) load_mean(body, block, work, dilation);
      load_velocities(body, block, work);
      block.bounds.clear();
      for_each_chunk_of(body, block,
                        [&](const Chunk& chunk) { work.moved.extend(gather_one(pass, step, chunk, work)); });
      block.bounds.known = scene_.list && pass.has(Act::move);
    });
  return sum_gathered(pass.has(Act::move));
}

/// Lets every block gather from the grid and scatter for the next step into next_motion and the forces, which nothing
/// reads any more. The tile's margin may not suffice for the new positions: particles then only gather. Velocities and
/// the transfer's state are kept where the step is observed; else nothing reads them any more.
template <int D, class T, class Components>
typename ParticleStep<D, T, Components>::Fused ParticleStep<D, T, Components>::gather_scatter(const Pass& pass,
                                                                                              const StepInfo& step,
                                                                                              const StepInfo& next) {
  const std::vector<Channel>& channels = scattered_channels(pass);
  for (const Channel c : channels) grid_.clear(c);
  if (grid_.has(reached)) grid_.clear(reached);  // laws say anew what their nodes have reached
  for (auto& work : work_) work->moved = {};
  abandoned_ = false;
  const bool follows = scene_.plan.accounts_at(next.step);
  account_for(step, follows);
  const bool moves = (follows || accounted_) && energy_moves();
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, true, [&](Block<D>& block, Work& work) {
      load_velocities(body, block, work);
      begin_reach(block, work);
      block.kinetic_energy = block.phase_change = block.scattered_energy = block.scattered_mass = 0;
      block.strained = {}, block.scattered_momentum = {};
      for_each_chunk_of(
          body, block,
          [&](const Chunk& chunk) {
            work.moved.extend(gather_one(pass, step, chunk, work));
            if (abandoned_) return;
            if (!scatter_chunk(pass, next, chunk, work, next_motion, evaluates_for_scatter(pass))) abandoned_ = true;
            if (moves) block.scattered_energy += kinetic_energy(chunk, work);
            if (follows) add_scattered(chunk);
          },
          step.observed ? nullptr : work.passing_motion.data());
      if (!moves) block.scattered_energy = block.kinetic_energy;  // it has the same velocities and moments
      end_reach(block, work);
      if (!abandoned_) return flush(body, block, work, channels);
      for (const Channel c : channels) work.clear(c, kernels_.scalars);
    });
  Fused result;
  if (failure_.any()) failed_forces_ = {};
  result.gathered = sum_gathered(pass.has(Act::move));
  result.scattered = !abandoned_ && !must_sort() && !failed_forces_.any();
  if (!result.scattered && !failed_forces_.any() && !step.observed)
    throw std::logic_error("particles moved farther than the nodes around them, and their velocities were not kept");
  if (follows || moves) result.particles = sum_scattered();
  if (moves && abandoned_) result.particles.kinetic_energy = kinetic_energy_now();
  return result;
}

/// Gathers for one chunk from the tiles; returns how far its particles moved. The gather and the fused pass, which must
/// agree to the last bit, both call it, so it is compiled once.
template <int D, class T, class Components>
[[gnu::noinline]] auto ParticleStep<D, T, Components>::gather_one(const Pass& pass, const StepInfo& step,
                                                                  const Chunk& chunk, Work& work) -> Moved {
  const Wanted wanted{true, pass.has(Act::strain), motion, velocity_before, pass.has(Act::strain) ? dilation : -1};
  gather_chunk(chunk, work, wanted);
  work.clock.lap(Phase::coefficients);
  States state = transfer_states(chunk);
  T* const velocity = chunk.motion;
  T* const advection = pass.has(Act::move) ? work.advection : chunk.at(chunk.particles.advection);
  const mpm_gather_batch batch{static_cast<std::uint32_t>(chunk.end),
                               chunk_size<T>,
                               D,
                               0,
                               step.dt,
                               work.velocity,
                               scene_.has(MPM_GATHERS_INCREMENT) ? work.increment : nullptr,
                               scene_.has(MPM_GATHERS_AFFINE) ? work.affine : nullptr,
                               scene_.has(MPM_GATHERS_GRADIENT) ? work.gradient_of_velocity : nullptr,
                               velocity,
                               state.fields,
                               advection,
                               moments_for_transfer(chunk, work)};
  const bool by_mean = step.filtered && scene_.experiment.filter_schedule.moves_by_mean;
  T before[D * chunk_size<T>];
  if (by_mean) std::copy_n(velocity, D * chunk_size<T>, before);
  Components::gather(scene_, batch);
  if (higher_kernels_.gather) keep_higher(chunk, work);
  if (step.filtered)  // the filtered velocity replaces the particle's
    for (int c = 0; c < D; ++c)
      for (T* const target : {velocity, advection})
        std::copy_n(work.velocity + c * chunk_size<T>, chunk.end, target + c * chunk_size<T>);
  if (by_mean)
    for (int k = 0; k < D * chunk_size<T>; ++k) advection[k] = mean_velocity(before[k], velocity[k]);
  if (chunk.particles.grip >= 0) move_gripped(chunk, advection, step.time + step.dt);
  const bool corners = chunk.particles.corners >= 0;
  T* const moved = !corners              ? nullptr
                   : pass.has(Act::move) ? work.moved_corners.data()
                                         : chunk.at(chunk.particles.moved_corners);
  if (corners) gather_corners(chunk, work, advection, step.dt, moved);
  if (sums_energy_) chunk.block.kinetic_energy += kinetic_energy(chunk, work);
  work.clock.lap(Phase::transfer);
  if (pass.has(Act::strain)) advance_material(chunk, work, step.dt, pass);
  work.clock.lap(Phase::material);
  if (pass.has(Act::change_phase) && chunk.body.may_melt()) change_phases(chunk, work);
  if (!pass.has(Act::move)) return {};
  if (chunk.particles.next_domain >= 0)  // no pass of this step needs the old weights any more
    std::copy_n(chunk.at(chunk.particles.next_domain), D * D * chunk_size<T>, chunk.at(chunk.particles.domain));
  const Moved far = corners ? move_with_corners(chunk, work, moved)
                            : advance_position(chunk, advection, static_cast<T>(step.dt / scene_.domain.cell_size));
  if (scene_.list) extend_bounds(chunk);
  work.clock.lap(Phase::move);
  return far;
}

template <int D, class T, class Components>
auto ParticleStep<D, T, Components>::strain(const Pass& pass, const StepInfo& step) -> Gathered {
  account_for(step);
  const Wanted wanted{false, true, motion, -1, dilation};
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      kernels_.load(work.velocity_tile.data(), grid_.channel(motion, bodies_[body].field), block.neighbours.data(),
                    block.reach);
      load_mean(body, block, work, dilation);
      block.phase_change = block.heat_of_dissipation = 0, block.strained = {};
      block.bounds.known = false;
      for_each_chunk_of(body, block, [&](const Chunk& chunk) {
        gather_chunk(chunk, work, wanted);
        advance_material(chunk, work, step.dt, pass);
      });
    });
  return sum_gathered(false);
}

/// Sums over the nodes of a chunk's particles, as quads: in the tile, or on the grid for lists that leave it.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::gather_moments(const Chunk& chunk, Work& work, const T* tile, Channel channel,
                                                    bool moment, bool gradient) {
  if (!scene_.list) {
    const Stencils<T> stencils{work.first, work.shared_stencils, work.weight, work.gradient, chunk.ahead(true)};
    return kernels_.gather[moment][gradient](tile, stencils, work.quads, chunk.end);
  }
  if (scene_.evaluate_box && !work.far_only)
    list_kernels_.gather_boxes[moment][gradient](tile, work.boxes.boxes(), work.quads, chunk.end);
  const auto kernel = list_kernels_.gather_lists[moment][gradient];
  if (work.lists.any && !work.far_only) kernel(tile, work.lists.near_lists(), work.quads, chunk.end);
  if (work.lists.far > 0)
    kernel(grid_.channel(channel, chunk.body.field), work.lists.far_lists(), work.quads, chunk.end);
}

/// Fills velocity, increment, affine and gradient_of_velocity of the work space, as far as they will be read.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::gather_chunk(const Chunk& chunk, Work& work, const Wanted& wanted) {
  const bool affine =
      (wanted.transfer && scene_.has(MPM_GATHERS_AFFINE)) || (wanted.strain && scene_.has(MPM_STRAIN_BY_AFFINE));
  const bool moment = affine && !scene_.moment_is_gradient;
  const bool gradient = (wanted.strain && !scene_.has(MPM_STRAIN_BY_AFFINE)) ||
                        (wanted.transfer && scene_.has(MPM_GATHERS_GRADIENT)) || (affine && scene_.moment_is_gradient);
  work.clock.lap(Phase::other);
  evaluate_shape(chunk, work, gradient);
  place_to_gather(chunk, work);
  work.clock.lap(Phase::weights);
  const int n = chunk.end;
  gather_moments(chunk, work, work.velocity_tile.data(), wanted.channel, moment, gradient);
  work.clock.lap(Phase::gather);
  unpack_moments(work, moment, gradient, n);
  if (wanted.transfer && higher_kernels_.gather) {
    const Stencils<T> stencils{work.first, false, work.weight, work.gradient, {}};
    higher_kernels_.gather(work.velocity_tile.data(), stencils, work.offset, work.higher.data(), n);
  }
  if (moment && scene_.moment_of_particle) apply_inverse_moments(chunk, work);
  if (affine && scene_.moment_is_gradient)
    std::copy(work.gradient_of_velocity, work.gradient_of_velocity + D * D * chunk_size<T>, work.affine);
  if (wanted.transfer && wanted.increments >= 0 && scene_.has(MPM_GATHERS_INCREMENT)) {
    gather_moments(chunk, work, work.increment_tile.data(), wanted.increments, false, false);
    for (int p = 0; p < n; p += Lanes<T>::width) {
      Lanes<T> increment[4];
      load_quads<T>(work.quads + 4 * p, increment);
      for (int c = 0; c < D; ++c) increment[c].store(work.increment + c * chunk_size<T> + p);
    }
  }
  if (wanted.dilation >= 0) gather_mean(chunk, work, wanted.dilation);
}

/// Turns quads into velocity, C = h (sum k w v - f sum w v) D^-1 about the particle (without the D^-1 of moments a
/// particle), and L.
template <int D, class T, class Components>
template <bool Moment, bool Gradient>
void ParticleStep<D, T, Components>::unpack_moments(Work& work, int count) {
  using L = Lanes<T>;
  const double h = scene_.domain.cell_size;
  const T scale = static_cast<T>(scene_.moment_of_particle ? h : scene_.inverse_moment * h);
  const T inverse_h = static_cast<T>(1 / h);
  for (int p = 0; p < count; p += L::width) {
    const T* quads = work.quads + quad_place<T>(p, quad_groups(D, Moment, Gradient));
    L v[4];
    load_quads<T>(quads, v);
    for (int c = 0; c < D; ++c) v[c].store(work.velocity + c * chunk_size<T> + p);
#pragma GCC unroll 3
    for (int a = 0; Moment && a < D; ++a) {
      const L f = L::load(work.offset + a * chunk_size<T> + p);
      L sums[4];
      load_quads<T>(quads += quad_group<T>, sums);
      for (int c = 0; c < D; ++c) (scale * (sums[c] - f * v[c])).store(work.affine + (c * D + a) * chunk_size<T> + p);
    }
#pragma GCC unroll 3
    for (int a = 0; Gradient && a < D; ++a) {
      L sums[4];
      load_quads<T>(quads += quad_group<T>, sums);
      for (int c = 0; c < D; ++c)
        (inverse_h * sums[c]).store(work.gradient_of_velocity + (c * D + a) * chunk_size<T> + p);
    }
  }
}
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::unpack_moments(Work& work, bool moment, bool gradient, int count) {
  if (moment) return gradient ? unpack_moments<true, true>(work, count) : unpack_moments<true, false>(work, count);
  return gradient ? unpack_moments<false, true>(work, count) : unpack_moments<false, false>(work, count);
}

/// Makes the gathered coefficients the particles' own.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::keep_higher(const Chunk& chunk, const Work& work) const {
  const int components = scene_.plan.basis_functions * D;
  for (int c = 0; c < components; ++c)
    std::copy_n(work.higher.data() + c * chunk_size<T>, chunk.end, chunk.higher() + c * chunk_size<T>);
}

/// Multiplies C <- C D^-1 where each particle has its own moments.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::apply_inverse_moments(const Chunk& chunk, Work& work) const {
  if (scene_.list) return multiply_by_inverse_moments(chunk, work);
  for (int c = 0; c < D; ++c)
    for (int a = 0; a < D; ++a)
      for (int p = 0; p < chunk.end; ++p)
        work.affine[(c * D + a) * chunk_size<T> + p] *= work.inverse_moment[a * chunk_size<T> + p];
}

/// Gives D of the last shape evaluation as the transfer reads it, cells^2; null where it is a multiple of the identity.
template <int D, class T, class Components>
const T* ParticleStep<D, T, Components>::moments_for_transfer(const Chunk& chunk, Work& work) const {
  const bool varies = scene_.moment_of_particle || scene_.moment_is_gradient;
  if (!varies || !scene_.has(MPM_READS_SECOND_MOMENT)) return nullptr;
  if (scene_.list) return work.second_moment;
  for (int a = 0; a < D; ++a)
    for (int p = 0; p < chunk.end; ++p) {
      const T f = work.offset[a * chunk_size<T> + p];
      work.transfer_moment[a * (D + 1) * chunk_size<T> + p] =
          scene_.moment_of_particle ? work.second_moment[a * chunk_size<T> + p] : f * (T(1) - f);
    }
  return work.transfer_moment;
}

/// Executes one pass of the filter's loop: the transfer itself gathers v* and scatters it again.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::project(const StepInfo& step) {
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    const int field = bodies_[body].field;
    for_each_block(body, true, [&](Block<D>& block, Work& work) {
      kernels_.load(work.velocity_tile.data(), grid_.channel(filter_increment, field), block.neighbours.data(),
                    block.reach);
      for_each_chunk_of(body, block, [&](const Chunk& chunk) { project_chunk(step, chunk, work); });
      flush(body, block, work, filter_projection);
    });
    scatter_far(body, [&](const Chunk& chunk, Work& work) { project_chunk(step, chunk, work); });
  }
  failure_.raise();
}

/// Calls the transfer for a particle at rest with zero state, so that what it scatters is linear in v*.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::project_chunk(const StepInfo& step, const Chunk& chunk, Work& work) {
  const Wanted wanted{true, false, filter_increment};
  gather_chunk(chunk, work, wanted);
  T* const velocity = work.scratch_velocity.data();
  std::fill_n(velocity, D * chunk_size<T>, T(0));
  States state{};
  T* next = work.scratch_state.data();
  for (std::size_t f = 0; f < chunk.particles.transfer_state.size(); ++f) {
    state.fields[f] = next;
    next = std::fill_n(next, chunk.particles.transfer_state[f].field->components * chunk_size<T>, T(0));
  }
  const std::uint32_t n = static_cast<std::uint32_t>(chunk.end);
  const mpm_gather_batch gathered{n,
                                  chunk_size<T>,
                                  D,
                                  0,
                                  step.dt,
                                  work.velocity,
                                  scene_.has(MPM_GATHERS_INCREMENT) ? work.velocity : nullptr,
                                  scene_.has(MPM_GATHERS_AFFINE) ? work.affine : nullptr,
                                  scene_.has(MPM_GATHERS_GRADIENT) ? work.gradient_of_velocity : nullptr,
                                  velocity,
                                  state.fields,
                                  work.advection,
                                  moments_for_transfer(chunk, work)};
  Components::gather(scene_, gathered);
  fill_masses(chunk, work);
  const bool affine = scene_.has(MPM_SCATTERS_AFFINE);
  const mpm_scatter_batch scattered{
      n, chunk_size<T>, D, 0, work.mass, velocity, state.fields, work.b, affine ? work.A : nullptr};
  Components::scatter(scene_, scattered);
  if (!scene_.list) place_to_scatter(chunk, work, false);
  add_to_tile(chunk, work, filter_projection, work.mass, true, affine, false);
  if (higher_kernels_.scatter) add_higher_to_tile(chunk, work, filter_projection, work.higher.data());
}

/// Strains the particles by the pass's share of the step; where the pass scatters them too, also gives what that wants
/// of the material.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::advance_material(const Chunk& chunk, Work& work, double dt, const Pass& pass) {
  const bool dissipation = chunk.body.warms_itself || (accounted_ && chunk.body.dissipates);
  mpm_material_batch request{};
  request.dt = pass.share * dt;
  T* const velocity_gradient = scene_.has(MPM_STRAIN_BY_AFFINE) ? work.affine : work.gradient_of_velocity;
  request.velocity_gradient = velocity_gradient;
  if (scene_.axisymmetric) {  // b is free between gather and scatter
    find_hoop_rates(chunk, work, work.b);
    request.velocity_gradient_zz = work.b;
  }
  if (dilation >= 0) take_mean_dilations(chunk, work, velocity_gradient, work.b, static_cast<T>(request.dt));
  if (dissipation) request.dissipated_energy = work.scalar;
  if (evaluates_for_scatter(pass)) want_of_material(pass, chunk.block, work, request);
  const bool spreads_shocks = chunk.particles.artificial_pressure >= 0;
  alignas(64) T wave_speed[chunk_size<T>];
  if (spreads_shocks) request.wave_speed = wave_speed;
  alignas(64) T stored_energy[chunk_size<T>];
  if (accounted_) {
    mpm_material_batch now{};
    now.kirchhoff_stress = work.stress, now.stored_energy = stored_energy;
    update_material(chunk, now);
    if (spreads_shocks) add_artificial_pressure(chunk, work);
    book_stress(chunk, now, request, false);
    request.kirchhoff_stress = work.stress, request.stored_energy = stored_energy;
  }
  update_material(chunk, request);
  if (spreads_shocks) strain_artificially(chunk, work, request);
  if (accounted_) book_stress(chunk, request, request, true);
  if (chunk.particles.domain >= 0 && !chunk.body.frozen)
    advance_domain(chunk, velocity_gradient, request.dt, pass.second_half());
  if (chunk.particles.deformation >= 0 && !chunk.body.frozen) {
    T* const deformation = chunk.at(chunk.particles.deformation);
    advance_columns(deformation, deformation, velocity_gradient, request.dt, chunk.end);
  }
  if (chunk.body.warms_itself) warm_by_dissipation(chunk, work);
  if (!dissipation || !accounted_) return;
  const T* const size = sizes(chunk);
  const auto energies = [&](int p) {
    const Lanes<T> energy = Lanes<T>::load(work.scalar + p);
    return size ? energy * Lanes<T>::load(size + p) : energy;
  };
  chunk.block.strained.dissipated += chunk.body.volume * sum_of_particles<T>(chunk.count, energies);
}

/// Adds half of the work of the stresses `now` on a strain, and the stored energy: before the strain with the other sign,
/// `after` it of what dt L is of the strained body, dt L (I + dt L)^-1 to second order.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::book_stress(const Chunk& chunk, const mpm_material_batch& now,
                                                 const mpm_material_batch& strain, bool after) {
  const T *const stress = static_cast<const T*>(now.kirchhoff_stress), *const energy =
                                                                           static_cast<const T*>(now.stored_energy);
  const T* const L = static_cast<const T*>(strain.velocity_gradient);
  const T* const hoop = static_cast<const T*>(strain.velocity_gradient_zz);
  const T* const size = sizes(chunk);
  const auto of_strained = [&](double rate, double squared) { return after ? rate - strain.dt * squared : rate; };
  double power = 0, stored = 0;
  for (int p = 0; p < chunk.count; ++p) {
    const auto at = [&](const T* values, int component) { return double(values[component * chunk_size<T> + p]); };
    double sum = hoop ? at(stress, 2) * of_strained(hoop[p], double(hoop[p]) * hoop[p]) : 0.0;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) {
        double squared = 0;
        for (int k = 0; k < D; ++k) squared += at(L, i * D + k) * at(L, k * D + j);
        sum += at(stress, Sym<D, T>::index(i, j)) * of_strained(at(L, i * D + j), squared);
      }
    const double share = size ? double(size[p]) : 1.0;
    power += share * sum;
    stored += share * at(energy, 0);
  }
  chunk.block.strained.power += 0.5 * strain.dt * chunk.body.volume * power;
  chunk.block.strained.stored += (after ? 1 : -1) * chunk.body.volume * stored;
}

template <int D, class T, class Components>
double ParticleStep<D, T, Components>::kinetic_energy_now() {
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      block.kinetic_energy = 0;
      for_each_chunk_of(body, block, [&](const Chunk& chunk) {
        evaluate_moments(chunk, work);
        block.kinetic_energy += kinetic_energy(chunk, work);
      });
    });
  double sum = 0;
  for (const auto& particles : particles_)
    for (const Block<D>& block : particles.blocks) sum += block.kinetic_energy;
  return sum;
}

/// Sets domain <- (I + dt L) domain. USF goes on with the old weights until its gather; with `again` what was strained
/// in this step already is strained further.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::advance_domain(const Chunk& chunk, const T* velocity_gradient, double dt,
                                                    bool again) const {
  const int strained = chunk.particles.next_domain < 0 ? chunk.particles.domain : chunk.particles.next_domain;
  const T* const from = chunk.at(again ? strained : chunk.particles.domain);
  advance_columns(from, chunk.at(strained), velocity_gradient, dt, chunk.end);
}

/// Sets the matrices `to` <- (I + dt L) `from`, which may be the same.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::advance_columns(const T* from, T* to, const T* velocity_gradient, double dt,
                                                     int count) const {
  using V = Lanes<T>;
  const T step = static_cast<T>(dt);
  for (int p = 0; p < count; p += V::width) {
    V L[D * D];
    for (int c = 0; c < D * D; ++c) L[c] = V::load(velocity_gradient + c * chunk_size<T> + p);
    for (int k = 0; k < D; ++k) {  // column by column
      V side[D];
      for (int b = 0; b < D; ++b) side[b] = V::load(from + (b * D + k) * chunk_size<T> + p);
      for (int a = 0; a < D; ++a) {
        V rate = L[a * D] * side[0];
        for (int b = 1; b < D; ++b) rate = rate + L[a * D + b] * side[b];
        (side[a] + step * rate).store(to + (a * D + k) * chunk_size<T> + p);
      }
    }
  }
}

/// The room beyond a face that cannot be folded away, in cells: half a cell at a separating wall, rounding elsewhere.
template <int D, class T, class Components>
double ParticleStep<D, T, Components>::margin(int axis, int side) const {
  if (scene_.domain.faces[axis][side] == ConditionType::separate) return 0.5;
  return 1e-9 * scene_.domain.cells[axis] + 8 * static_cast<double>(std::numeric_limits<T>::epsilon());
}

/// The least position with r > 0, in cells from the block's first node; only the radius has this bound.
template <int D, class T, class Components>
T ParticleStep<D, T, Components>::least_place(const Block<D>& block, int axis) const {
  if (!scene_.axisymmetric || axis != 0) return std::numeric_limits<T>::lowest();
  const T to_axis = cells_from_axis(scene_, block);
  return to_axis == T(0) ? std::numeric_limits<T>::min() : std::nextafter(-to_axis, std::numeric_limits<T>::max());
}

/// Gives the particles of a chunk the mean of what the nodes around them say, over those where their field met another,
/// if it is more than they have.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::keep_contact_state(const Chunk& chunk, Work& work) {
  const int states = static_cast<int>(scene_.experiment.contact_state().size());
  evaluate_shape(chunk, work, false);
  place_to_gather(chunk, work);
  gather_moments(chunk, work, work.mean_tile.data(), reached, false, false);
  for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
    Lanes<T> of_nodes[4];
    load_quads<T>(work.quads + 4 * p, of_nodes);
    const Lanes<T> met = of_nodes[3], zero(T(0)), any = max(met, Lanes<T>(std::numeric_limits<T>::min()));
    for (int k = 0; k < states; ++k) {
      T* const state = chunk.at(chunk.particles.contact_state + k) + p;
      const Lanes<T> before = Lanes<T>::load(state), gain = max(of_nodes[k] / any - before, zero);
      gain.store(chunk.at(chunk.particles.contact_gain + k) + p);
      (before + gain).store(state);
    }
  }
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::keep_contact_state() {
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      load_mean(body, block, work, reached);
      for_each_chunk_of(body, block, [&](const Chunk& chunk) { keep_contact_state(chunk, work); });
    });
  failure_.raise();
}

/// Moves by x += scale times the advection velocity, in cells.
template <int D, class T, class Components>
auto ParticleStep<D, T, Components>::advance_position(const Chunk& chunk, const T* advection, T scale) -> Moved {
  using L = Lanes<T>;
  if (chunk.body.frozen) scale = T(0);
  L largest(T(0)), outside(T(0)), farthest(T(0));
  for (int axis = 0; axis < D; ++axis) {
    T low = -std::numeric_limits<T>::max(), high = std::numeric_limits<T>::max();
    if (!scene_.domain.periodic(axis)) {
      const double origin = chunk.block.at[axis] * block_side<D>;
      low = std::max(static_cast<T>(-margin(axis, 0) - origin), least_place(chunk.block, axis));
      high = static_cast<T>(scene_.domain.cells[axis] + margin(axis, 1) - origin);
    }
    // Places are known to a part of a cell, see find_first_places.
    const T first = chunk.body.first_place[axis], beyond = first + block_side<D> - T(1) / chunk_size<T>;
    T* const x = chunk.at(Particles<D, T>::position + axis);
    const T* const v = advection + axis * chunk_size<T>;
    for (int p = 0; p < chunk.end; p += L::width) {
      const L change = scale * L::load(v + p), moved = L::load(x + p) + change;
      moved.store(x + p);
      largest = max(largest, abs(change));
      farthest = max(farthest, max(first - moved, moved - beyond));
      outside = select(moved >= low, select(moved <= high, outside, L(T(1))), L(T(1)));  // a NaN is outside
    }
  }
  if (any_lane<T>(outside > T(0))) note_outside(chunk);
  return {largest_lane(largest), largest_lane(farthest)};
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::note_outside(const Chunk& chunk) {
  for (int p = 0; p < chunk.count; ++p)
    for (int axis = 0; axis < D; ++axis) {
      const double x = chunk.at(Particles<D, T>::position + axis)[p], cells = scene_.domain.cells[axis];
      const double from_corner = x + chunk.block.at[axis] * block_side<D>;
      const double place = scene_.domain.lower[axis] + scene_.domain.cell_size * from_corner;
      if (!std::isfinite(x))
        note(Cause::position_not_a_number, chunk, p, axis, place);
      else if (chunk.at(Particles<D, T>::position + axis)[p] < least_place(chunk.block, axis))
        note(Cause::reached_axis, chunk, p, axis, place);
      else if (!scene_.domain.periodic(axis) &&
               !(from_corner >= -margin(axis, 0) && from_corner <= cells + margin(axis, 1)))
        note(Cause::left_domain, chunk, p, axis, place);
    }
}

/// Moves particles in a pass of its own; the gather before it has set `moved` back.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::move(const StepInfo& step) {
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      block.bounds.known = false;
      const T scale = static_cast<T>(step.dt / scene_.domain.cell_size);
      for_each_chunk_of(body, block, [&](const Chunk& chunk) {
        const Particles<D, T>& particles = chunk.particles;
        work.moved.extend(particles.corners >= 0 ? move_with_corners(chunk, work, chunk.at(particles.moved_corners))
                                                 : advance_position(chunk, chunk.at(particles.advection), scale));
      });
    });
  account_for_move();
  failure_.raise();
}

template <int D, class T, class Components>
TimeStepLimit ParticleStep<D, T, Components>::time_step_limit() {
  TimeStepLimit best;
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    TimeStepLimit of_body;
    of_body.body = body;
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      TimeStepLimit of_block;
      of_block.body = body;
      for_each_chunk_of(body, block, [&](const Chunk& chunk) {
        mpm_material_batch request{};
        request.wave_speed = work.scalar;
        update_material(chunk, request);
        if (chunk.particles.artificial_pressure >= 0) damp_wave_speeds(chunk, work);
        const T* const v = chunk.at(Particles<D, T>::velocity);
        for (int p = 0; p < chunk.count; ++p) {
          double squared = 0;
          for (int c = 0; c < D; ++c)
            squared += static_cast<double>(v[c * chunk_size<T> + p]) * v[c * chunk_size<T> + p];
          const double wave = work.scalar[p], speed = wave + std::sqrt(squared);
          const std::size_t id = static_cast<std::size_t>(chunk.ids[p]);
          if (speed > of_block.speed || (speed == of_block.speed && id < of_block.particle))
            of_block = {speed, wave, body, id};
        }
      });
      const std::lock_guard lock(mutex_);
      if (of_block.speed > of_body.speed || (of_block.speed == of_body.speed && of_block.particle < of_body.particle))
        of_body = of_block;
    });
    failure_.raise();
    if (of_body.speed > best.speed) best = of_body;
  }
  return best;
}

}  // namespace mpm::cpu
