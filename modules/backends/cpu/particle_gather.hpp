#pragma once
// ParticleStep: grid to particles, strain, movement and the time step's limit.

#include <cmath>
#include <sstream>

#include "kernel/lanes.hpp"
#include "particle_chunks.hpp"

namespace mpm::cpu {

template <int D, class T>
typename ParticleStep<D, T>::Gathered ParticleStep<D, T>::gather(const Pass& pass, const StepInfo& step) {
  std::fill(drift_of_thread_.begin(), drift_of_thread_.end(), 0.0);
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      const int field = bodies_[body].field;
      kernels_.load(work.tile[motion].data(), grid_.channel(motion, field), block.neighbours.data(), block.reach);
      if (scene_.has(MPM_GATHERS_INCREMENT))
        kernels_.load(work.tile[velocity_before].data(), grid_.channel(velocity_before, field), block.neighbours.data(),
                      block.reach);
      block.kinetic_energy = block.dissipated = 0;
      double& drift = drift_of_thread_[omp_get_thread_num()];
      for_each_chunk_of(body, block, [&](const Chunk& chunk) {
        gather_chunk(chunk, work, true, pass.strain);
        States state = states(chunk.particles.transfer_state, chunk);
        const bool increment = scene_.has(MPM_GATHERS_INCREMENT), affine = scene_.has(MPM_GATHERS_AFFINE);
        T* const advection = pass.move ? work.advection : chunk.at(chunk.particles.advection);
        const mpm_gather_batch batch{static_cast<std::uint32_t>(chunk.end),
                                     chunk_size,
                                     D,
                                     0,
                                     step.dt,
                                     work.velocity,
                                     increment ? work.increment : nullptr,
                                     affine ? work.affine : nullptr,
                                     nullptr,
                                     chunk.at(Particles<D, T>::velocity),
                                     state.fields,
                                     advection};
        scene_.transfer_gather(scene_.transfer_parameters, &batch);
        if (scene_.plan.ledger) block.kinetic_energy += kinetic_energy(chunk, work);
        if (pass.strain) advance_material(chunk, work, step.dt);
        if (pass.move) drift = std::max(drift, advance_position(chunk, advection, step.dt));
      });
      work.clear(motion, kernels_.nodes);
      if (scene_.has(MPM_GATHERS_INCREMENT)) work.clear(velocity_before, kernels_.nodes);
    });
  drift_ += *std::max_element(drift_of_thread_.begin(), drift_of_thread_.end());
  throw_failure();
  Gathered sum;
  for (const auto& particles : particles_)
    for (const Block<D>& block : particles.blocks) {
      sum.kinetic_energy += block.kinetic_energy;
      sum.dissipated += block.dissipated;
    }
  return sum;
}

template <int D, class T>
double ParticleStep<D, T>::strain(const StepInfo& step) {
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work& work) {
      kernels_.load(work.tile[motion].data(), grid_.channel(motion, bodies_[body].field), block.neighbours.data(),
                    block.reach);
      block.dissipated = 0;
      for_each_chunk_of(body, block, [&](const Chunk& chunk) {
        gather_chunk(chunk, work, false, true);
        advance_material(chunk, work, step.dt);
      });
      work.clear(motion, kernels_.nodes);
    });
  throw_failure();
  double sum = 0;
  for (const auto& particles : particles_)
    for (const Block<D>& block : particles.blocks) sum += block.dissipated;
  return sum;
}

/// Fills velocity, increment, affine and gradient_of_velocity of the work space, as far as they will be read.
template <int D, class T>
void ParticleStep<D, T>::gather_chunk(const Chunk& chunk, Work& work, bool update_velocity, bool strain) {
  const bool affine =
      (update_velocity && scene_.has(MPM_GATHERS_AFFINE)) || (strain && scene_.has(MPM_STRAIN_BY_AFFINE));
  const bool moment = affine && !scene_.moment_is_gradient;
  const bool gradient = (strain && !scene_.has(MPM_STRAIN_BY_AFFINE)) || (affine && scene_.moment_is_gradient);
  evaluate_shape(chunk, work, gradient);
  place_in_tile(chunk, work, false);
  const Stencils<T> stencils{work.tile_node, work.weight, work.gradient};
  const int groups = quad_groups(D, moment, gradient), n = chunk.end;
  kernels_.gather[moment][gradient](work.tile[motion].data(), stencils, work.quads, n);
  unpack_quads<D, T>(work.quads, groups,
                     {work.velocity, work.velocity + chunk_size, work.velocity + (D - 1) * chunk_size}, n);
  if (moment) affine_from_moments(chunk, work, groups);
  if (gradient) {
    T* const L = work.gradient_of_velocity;
    const T* const quads = work.quads + 4 * (1 + (moment ? D : 0));
    for (int a = 0; a < D; ++a)
      unpack_quads<D, T>(quads + 4 * a, groups,
                         {L + a * chunk_size, L + (D + a) * chunk_size, L + ((D - 1) * D + a) * chunk_size}, n);
    const T inverse_h = static_cast<T>(1 / scene_.domain.cell_size);
    for (int k = 0; k < D * D; ++k)
      for (int p = 0; p < n; ++p) L[k * chunk_size + p] *= inverse_h;
    if (affine && scene_.moment_is_gradient) std::copy(L, L + D * D * chunk_size, work.affine);
  }
  if (update_velocity && scene_.has(MPM_GATHERS_INCREMENT)) {
    kernels_.gather[0][0](work.tile[velocity_before].data(), stencils, work.quads, n);
    unpack_quads<D, T>(work.quads, 1,
                       {work.increment, work.increment + chunk_size, work.increment + (D - 1) * chunk_size}, n);
  }
}

/// C = D^-1 h (sum k w v - f sum w v): the moment about the particle.
template <int D, class T>
void ParticleStep<D, T>::affine_from_moments(const Chunk& chunk, Work& work, int groups) {
  const T scale = static_cast<T>(scene_.inverse_moment * scene_.domain.cell_size);
  T* const C = work.affine;
  for (int a = 0; a < D; ++a) {
    unpack_quads<D, T>(work.quads + 4 * (1 + a), groups,
                       {C + a * chunk_size, C + (D + a) * chunk_size, C + ((D - 1) * D + a) * chunk_size}, chunk.end);
    const T* const f = work.offset + a * chunk_size;
    for (int c = 0; c < D; ++c) {
      T* const Cca = C + (c * D + a) * chunk_size;
      const T* const v = work.velocity + c * chunk_size;
      for (int p = 0; p < chunk.end; ++p) Cca[p] = scale * (Cca[p] - f[p] * v[p]);
    }
  }
}

template <int D, class T>
void ParticleStep<D, T>::advance_material(const Chunk& chunk, Work& work, double dt) {
  const bool dissipation = scene_.plan.ledger && chunk.body.dissipates;
  mpm_material_batch request{};
  request.dt = dt;
  request.velocity_gradient = scene_.has(MPM_STRAIN_BY_AFFINE) ? work.affine : work.gradient_of_velocity;
  if (dissipation) request.dissipated_energy = work.scalar;
  update_material(chunk, request);
  if (!dissipation) return;
  double sum = 0;
  for (int p = 0; p < chunk.count; ++p) sum += work.scalar[p];
  chunk.block.dissipated += chunk.body.volume * sum;
}

/// Room beyond a face that cannot be folded away, in cells: half a cell at a separating wall, rounding elsewhere.
template <int D, class T>
double ParticleStep<D, T>::margin(int axis, int side) const {
  if (scene_.domain.faces[axis][side] == ConditionType::separate) return 0.5;
  return 1e-9 * scene_.domain.cells[axis] + 8 * static_cast<double>(std::numeric_limits<T>::epsilon());
}

/// x += dt times the advection velocity; returns the largest displacement in cells.
template <int D, class T>
double ParticleStep<D, T>::advance_position(const Chunk& chunk, const T* advection, double dt) {
  using L = Lanes<T>;
  const T scale = static_cast<T>(dt / scene_.domain.cell_size);
  L largest(T(0)), outside(T(0));
  for (int axis = 0; axis < D; ++axis) {
    T low = -std::numeric_limits<T>::max(), high = std::numeric_limits<T>::max();
    if (!scene_.domain.periodic(axis)) {
      const double origin = chunk.block.at[axis] * block_side<D>;
      low = static_cast<T>(-margin(axis, 0) - origin);
      high = static_cast<T>(scene_.domain.cells[axis] + margin(axis, 1) - origin);
    }
    T* const x = chunk.at(Particles<D, T>::position + axis);
    const T* const v = advection + axis * chunk_size;
    for (int p = 0; p < chunk.end; p += L::width) {
      const L change = scale * L::load(v + p), moved = L::load(x + p) + change;
      moved.store(x + p);
      largest = max(largest, abs(change));
      outside = select(moved >= low, select(moved <= high, outside, L(T(1))), L(T(1)));  // a NaN is outside
    }
  }
  T distance = 0;
  bool any_outside = false;
  for (int i = 0; i < L::width; ++i) {
    distance = std::max(distance, largest[i]);
    any_outside = any_outside || outside[i] != 0;
  }
  if (any_outside) note_outside(chunk);
  return distance;
}

template <int D, class T>
void ParticleStep<D, T>::note_outside(const Chunk& chunk) {
  const std::lock_guard lock(mutex_);
  for (int p = 0; p < chunk.count; ++p)
    for (int axis = D - 1; axis >= 0; --axis) {  // the first axis is noted last and wins
      const double x = chunk.at(Particles<D, T>::position + axis)[p], cells = scene_.domain.cells[axis];
      const double from_corner = x + chunk.block.at[axis] * block_side<D>;
      if (!std::isfinite(x)) {
        failure_.note(1, chunk.body.index, chunk.ids[p], "not a number: its position is no longer finite");
        break;
      }
      if (scene_.domain.periodic(axis) || (from_corner >= -margin(axis, 0) && from_corner <= cells + margin(axis, 1)))
        continue;
      std::ostringstream cause;
      cause << "left the domain at "
            << "xyz"[axis] << " = " << scene_.domain.lower[axis] + scene_.domain.cell_size * from_corner << " m";
      failure_.note(1, chunk.body.index, chunk.ids[p], cause.str());
    }
}

template <int D, class T>
void ParticleStep<D, T>::move(const StepInfo& step) {
  std::fill(drift_of_thread_.begin(), drift_of_thread_.end(), 0.0);
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    for_each_block(body, false, [&](Block<D>& block, Work&) {
      double& drift = drift_of_thread_[omp_get_thread_num()];
      for_each_chunk_of(body, block, [&](const Chunk& chunk) {
        drift = std::max(drift, advance_position(chunk, chunk.at(chunk.particles.advection), step.dt));
      });
    });
  drift_ += *std::max_element(drift_of_thread_.begin(), drift_of_thread_.end());
  throw_failure();
}

template <int D, class T>
TimeStepLimit ParticleStep<D, T>::time_step_limit() {
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
        const T* const v = chunk.at(Particles<D, T>::velocity);
        for (int p = 0; p < chunk.count; ++p) {
          double squared = 0;
          for (int c = 0; c < D; ++c) squared += static_cast<double>(v[c * chunk_size + p]) * v[c * chunk_size + p];
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
    throw_failure();
    if (of_body.speed > best.speed) best = of_body;
  }
  return best;
}

}  // namespace mpm::cpu
