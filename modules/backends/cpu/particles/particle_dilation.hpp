#pragma once
// This part of ParticleStep averages against locking: sums by volume of the particles' mean stresses, or of their
// dilations, go to the nodes, and what the nodes make of them takes the place of each particle's own.

#include "backends/cpu/particles/particle_gather.hpp"
#include "operators/dilation.hpp"

namespace mpm::cpu {

/// The velocity gradient of a pack of particles, with its zz around an axis.
template <int D, class T, bool Axisymmetric>
auto gradient_of_pack(const T* gradient, const T* hoop, int p) {
  Mat<D, Lanes<T>> L;
  for (int c = 0; c < D * D; ++c) L.m[c] = Lanes<T>::load(gradient + c * chunk_size<T> + p);
  if constexpr (Axisymmetric && D == 2)
    return Deformation<2, Lanes<T>>{L, Lanes<T>::load(hoop + p)};
  else
    return L;
}

/// Computes v_r / r of a chunk's particles, 1/s.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::find_hoop_rates(const Chunk& chunk, const Work& work, T* hoop) const {
  for (int p = 0; p < chunk.end; p += Lanes<T>::width)
    (Lanes<T>::load(work.velocity + p) / radius(chunk, p)).store(hoop + p);
}

/// The mean of the normal Kirchhoff stresses of a pack in the directions that a dilation strains, Pa.
template <int D, class T, class Components>
Lanes<T> ParticleStep<D, T, Components>::mean_normal_stress(const Work& work, int p) const {
  Lanes<T> sum = Lanes<T>::load(work.stress + p);
  for (int k = 1; k < dilated_directions(); ++k) sum = sum + Lanes<T>::load(work.stress + k * chunk_size<T> + p);
  return static_cast<T>(1.0 / dilated_directions()) * sum;
}

// ---- particles to nodes ------------------------------------------------------------------------------------------

/// Calls visit(chunk, work) for all chunks, which scatters them into the tile of a channel, cleared before. With `velocity`
/// it may gather that.
template <int D, class T, class Components>
template <class Visit>
void ParticleStep<D, T, Components>::scatter_average(Channel channel, bool velocity, Visit&& visit) {
  grid_.clear(channel);
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    for_each_block(body, true, [&](Block<D>& block, Work& work) {
      if (velocity)
        kernels_.load(work.velocity_tile.data(), grid_.channel(motion, bodies_[body].field), block.neighbours.data(),
                      block.reach);
      for_each_chunk_of(body, block, [&](const Chunk& chunk) { visit(chunk, work); });
      flush(body, block, work, channel);
    });
    scatter_far(body, visit);
  }
  failure_.raise();
}

/// Scatters what stands in the first row of b, beside the volumes in `scalar`. Of the nodes nobody reads another row.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_sum_by_volume(const Chunk& chunk, Work& work, Channel channel) {
  if (!scene_.list) place_to_scatter(chunk, work, false);
  add_to_tile(chunk, work, channel, work.scalar, true, false, false);
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_mean_stress() {
  scatter_average(mean_stress, false, [&](const Chunk& chunk, Work& work) { scatter_mean_stress(chunk, work); });
}

/// Scatters V0 J and, of the mean Cauchy stress times that, V0 times the mean Kirchhoff stress.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_mean_stress(const Chunk& chunk, Work& work) {
  evaluate_shape(chunk, work, false);
  mpm_material_batch request{};
  request.kirchhoff_stress = work.stress, request.volume_ratio = work.volume_ratio;
  update_material(chunk, request);
  if (chunk.particles.artificial_pressure >= 0) add_artificial_pressure(chunk, work);
  const T* const size = sizes(chunk);
  for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
    Lanes<T> volume = Lanes<T>(static_cast<T>(chunk.body.volume));
    if (size) volume = volume * Lanes<T>::load(size + p);
    (volume * Lanes<T>::load(work.volume_ratio + p)).store(work.scalar + p);
    (volume * mean_normal_stress(work, p)).store(work.b + p);
  }
  scatter_sum_by_volume(chunk, work, mean_stress);
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_dilation(const Pass& pass, const StepInfo& step) {
  const T dt = static_cast<T>(pass.share * step.dt);
  scatter_average(dilation, true, [&](const Chunk& chunk, Work& work) { scatter_dilation(chunk, work, dt); });
}

/// Gathers velocity gradients and scatters what they make of the volumes, in one visit.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_dilation(const Chunk& chunk, Work& work, T dt) {
  gather_chunk(chunk, work, {false, true, motion});
  mpm_material_batch request{};
  request.volume_ratio = work.volume_ratio;
  update_material(chunk, request);
  const T* const gradient = scene_.has(MPM_STRAIN_BY_AFFINE) ? work.affine : work.gradient_of_velocity;
  const T* const size = sizes(chunk);
  const T volume = static_cast<T>(chunk.body.volume);
  alignas(64) T hoop[chunk_size<T>];
  if (scene_.axisymmetric) find_hoop_rates(chunk, work, hoop);
  const auto weigh = [&](auto axisymmetric) {
    for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
      Lanes<T> of_particle = volume * Lanes<T>::load(work.volume_ratio + p);
      if (size) of_particle = of_particle * Lanes<T>::load(size + p);
      of_particle.store(work.scalar + p);
      const auto L = gradient_of_pack<D, T, axisymmetric.value>(gradient, hoop, p);
      (of_particle * dilation_of(L, Lanes<T>(dt))).store(work.b + p);
    }
  };
  scene_.axisymmetric ? weigh(std::true_type()) : weigh(std::false_type());
  scatter_sum_by_volume(chunk, work, dilation);
}

// ---- nodes to particles ------------------------------------------------------------------------------------------

/// Gathers an average of the nodes on stencils that have been placed.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::gather_mean(const Chunk& chunk, Work& work, Channel channel) {
  gather_moments(chunk, work, work.mean_tile.data(), channel, false, false);
  for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
    Lanes<T> of_nodes[4];
    load_quads<T>(work.quads + 4 * p, of_nodes);
    of_nodes[0].store(work.mean + p);
  }
}

/// Sets the mean normal stress of a chunk's particles to the nodes'.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::take_mean_stress(const Chunk& chunk, Work& work) const {
  for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
    const Lanes<T> change =
        Lanes<T>::load(work.volume_ratio + p) * Lanes<T>::load(work.mean + p) - mean_normal_stress(work, p);
    for (int k = 0; k < dilated_directions(); ++k) {
      T* const normal = work.stress + k * chunk_size<T> + p;
      (Lanes<T>::load(normal) + change).store(normal);
    }
  }
}

/// Sets velocity gradients, and the rates around an axis, to those of the nodes' mean dilation.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::take_mean_dilations(const Chunk& chunk, const Work& work, T* gradient, T* hoop,
                                                         T dt) const {
  const auto take = [&](auto axisymmetric) {
    for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
      auto L = gradient_of_pack<D, T, axisymmetric.value>(gradient, hoop, p);
      take_mean_dilation(L, Lanes<T>::load(work.mean + p), Lanes<T>(dt));
      for (int c = 0; c < D * D; ++c) in_plane(L).m[c].store(gradient + c * chunk_size<T> + p);
      if constexpr (has_zz<decltype(L)>) L.zz.store(hoop + p);
    }
  };
  scene_.axisymmetric ? take(std::true_type()) : take(std::false_type());
}

}  // namespace mpm::cpu
