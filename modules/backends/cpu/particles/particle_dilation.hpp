#pragma once
// This part of ParticleStep averages the dilation that strains particles: its sums by volume go to the nodes, and what
// the nodes make of them takes the place of each particle's own.

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

/// Gathers velocity gradients and scatters what they make of the volumes, in one visit.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_dilation(const Pass& pass, const StepInfo& step) {
  const T dt = static_cast<T>(pass.share * step.dt);
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    for_each_block(body, true, [&](Block<D>& block, Work& work) {
      kernels_.load(work.velocity_tile.data(), grid_.channel(motion, bodies_[body].field), block.neighbours.data(),
                    block.reach);
      for_each_chunk_of(body, block, [&](const Chunk& chunk) { scatter_dilation(chunk, work, dt); });
      flush(body, block, work, dilation);
    });
    scatter_far(body, [&](const Chunk& chunk, Work& work) { scatter_dilation(chunk, work, dt); });
  }
  failure_.raise();
}

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
  std::fill_n(work.b + chunk_size<T>, (D - 1) * chunk_size<T>, T(0));
  if (!scene_.list) place_to_scatter(chunk, work, false);
  add_to_tile(chunk, work, dilation, work.scalar, true, false, false);
}

/// Gathers the nodes' mean dilation on stencils that have just gathered velocities.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::gather_dilation(const Chunk& chunk, Work& work) {
  gather_moments(chunk, work, work.dilation_tile.data(), dilation, false, false);
  for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
    Lanes<T> of_nodes[4];
    load_quads<T>(work.quads + 4 * p, of_nodes);
    of_nodes[0].store(work.mean_dilation + p);
  }
}

/// Sets velocity gradients, and the rates around an axis, to those of the mean dilation.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::take_mean_dilations(const Chunk& chunk, const Work& work, T* gradient, T* hoop,
                                                         T dt) const {
  const auto take = [&](auto axisymmetric) {
    for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
      auto L = gradient_of_pack<D, T, axisymmetric.value>(gradient, hoop, p);
      take_mean_dilation(L, Lanes<T>::load(work.mean_dilation + p), Lanes<T>(dt));
      for (int c = 0; c < D * D; ++c) in_plane(L).m[c].store(gradient + c * chunk_size<T> + p);
      if constexpr (has_zz<decltype(L)>) L.zz.store(hoop + p);
    }
  };
  scene_.axisymmetric ? take(std::true_type()) : take(std::false_type());
}

}  // namespace mpm::cpu
