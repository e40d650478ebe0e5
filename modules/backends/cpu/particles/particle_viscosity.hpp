#pragma once
// This part of ParticleStep adds artificial viscosity to the stress of whatever law a body has.

#include "backends/cpu/particles/particle_dilation.hpp"
#include "kernel/artificial_viscosity.hpp"

namespace mpm::cpu {

/// Takes J q of the last strain from the normal stresses of a chunk's particles.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::add_artificial_pressure(const Chunk& chunk, Work& work) const {
  const T* const pressure = chunk.at(chunk.particles.artificial_pressure);
  for (int k = 0; k < 3; ++k)
    for (int p = 0; p < chunk.end; ++p) work.stress[k * chunk_size<T> + p] -= pressure[p];
}

/// Finds J q of a strain that the material has just made, and adds it to the stress and its work to what is dissipated,
/// where these are wanted.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::strain_artificially(const Chunk& chunk, Work& work,
                                                         const mpm_material_batch& strain) const {
  const T *const gradient = static_cast<const T*>(strain.velocity_gradient),
                 *const hoop = static_cast<const T*>(strain.velocity_gradient_zz),
                 *const speed = static_cast<const T*>(strain.wave_speed);
  T *const pressure = chunk.at(chunk.particles.artificial_pressure), *const dissipated =
                                                                         static_cast<T*>(strain.dissipated_energy);
  const T dt = static_cast<T>(strain.dt);
  alignas(64) T dissipation[chunk_size<T>];
  const auto visit = [&](auto axisymmetric) {
    for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
      const auto L = gradient_of_pack<D, T, axisymmetric.value>(gradient, hoop, p);
      const Lanes<T> change = log_of_change(volume_change(L, dt)), before = Lanes<T>::load(pressure + p);
      const Lanes<T> now = chunk.body.viscosity.pressure(compression_rate(change, dt), Lanes<T>::load(speed + p));
      now.store(pressure + p);
      // The trapezoidal rule: the forces before the strain had the old pressure, and those after it have the new one.
      (T(-0.5) * change * (before + now)).store(dissipation + p);
    }
  };
  scene_.axisymmetric ? visit(std::true_type()) : visit(std::false_type());
  if (strain.kirchhoff_stress) add_artificial_pressure(chunk, work);
  if (!dissipated) return;
  for (int p = 0; p < chunk.end; ++p) dissipated[p] += dissipation[p];
  if (!accounted_) return;
  const T* const size = sizes(chunk);
  chunk.block.strained.artificial += chunk.body.volume * sum_of_particles<T>(chunk.count, [&](int p) {
                                       const Lanes<T> energy = Lanes<T>::load(dissipation + p);
                                       return size ? energy * Lanes<T>::load(size + p) : energy;
                                     });
}

/// Replaces the speeds of the fastest waves by those that artificial viscosity asks a step to stand.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::damp_wave_speeds(const Chunk& chunk, Work& work) const {
  const T* const pressure = chunk.at(chunk.particles.artificial_pressure);
  const T inverse = static_cast<T>(1 / scene_.domain.cell_size);
  for (int p = 0; p < chunk.end; p += Lanes<T>::width) {
    const Lanes<T> speed = Lanes<T>::load(work.scalar + p);
    chunk.body.viscosity.damped_speed(speed * speed, Lanes<T>::load(pressure + p), inverse).store(work.scalar + p);
  }
}

}  // namespace mpm::cpu
