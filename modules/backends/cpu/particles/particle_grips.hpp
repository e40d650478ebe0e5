#pragma once
// This part of ParticleStep moves the particles of grips as they are told, and lets nodes know of them.

#include "backends/cpu/particles/particle_step.hpp"

namespace mpm::cpu {

/// The grip that moves a particle; the number of grips where none does.
template <int D, class T, class Components>
std::size_t ParticleStep<D, T, Components>::grip_of(const Chunk& chunk, int p) const {
  const T number = chunk.at(chunk.particles.grip)[p];
  return number > T(0) ? static_cast<std::size_t>(number) - 1 : grips_.size();
}

/// The place of a particle, m.
template <int D, class T, class Components>
Vector3 ParticleStep<D, T, Components>::place_of(const Chunk& chunk, int p) const {
  const T* const position = chunk.at(Particles<D, T>::position);
  Vector3 x{};
  for (int a = 0; a < D; ++a)
    x[a] = scene_.domain.lower[a] +
           scene_.domain.cell_size * cells_from_corner(scene_.domain, chunk.block, a, position[a * chunk_size<T> + p]);
  return x;
}

template <int D, class T, class Components>
Vector3 ParticleStep<D, T, Components>::velocity_of_gripped(const Chunk& chunk, int p, std::size_t grip,
                                                            double time) const {
  const Vector3 x = place_of(chunk, p);
  Vector3 X = x;
  for (int a = 0; a < D && chunk.body.initial_position; ++a)
    X[a] = chunk.body.initial_position[std::size_t(chunk.ids[p]) * D + a];
  return velocity_of(scene_.experiment, scene_.experiment.grips[grip], x, X, time);
}

/// Gives nodes the mass of gripped particles, with the momentum that these are told to have at the end of the step, and the
/// one that they have now.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::scatter_grips(const Chunk& chunk, Work& work, double end) {
  T told[D * chunk_size<T>];
  alignas(lane_bytes) T gripped[chunk_size<T>];
  for (std::size_t grip = 0; grip < grips_.size(); ++grip) {
    bool any = false;
    fill_masses(chunk, work);
    std::fill(told, told + D * chunk_size<T>, T(0));
    std::fill(work.b, work.b + D * chunk_size<T>, T(0));
    for (int p = 0; p < chunk.end; ++p) {
      gripped[p] = T(0);
      if (p >= chunk.count || grip_of(chunk, p) != grip) continue;
      any = true;
      gripped[p] = work.mass[p];
      const Vector3 velocity = velocity_of_gripped(chunk, p, grip, end);
      for (int c = 0; c < D; ++c) {
        told[c * chunk_size<T> + p] = work.mass[p] * static_cast<T>(velocity[c]);
        work.b[c * chunk_size<T> + p] = work.mass[p] * chunk.motion[c * chunk_size<T> + p];
      }
    }
    if (!any) continue;
    add_to_tile(chunk, work, grips_[grip][1], nullptr, true, false, false);
    std::copy(told, told + D * chunk_size<T>, work.b);
    add_to_tile(chunk, work, grips_[grip][0], gripped, true, false, false);
  }
}

/// Gives gripped particles the velocity that they are told to have, which moves them.
template <int D, class T, class Components>
void ParticleStep<D, T, Components>::move_gripped(const Chunk& chunk, T* advection, double end) {
  const Block<D>* const first = chunk.particles.blocks.data();
  GivenToGripped* const given = given_to_gripped_[static_cast<std::size_t>(chunk.body.index)].data() +
                                static_cast<std::size_t>(&chunk.block - first) * grips_.size();
  const T* const around = sizes(chunk);
  for (int p = 0; p < chunk.count; ++p) {
    const std::size_t grip = grip_of(chunk, p);
    if (grip == grips_.size()) continue;
    const Vector3 told = velocity_of_gripped(chunk, p, grip, end);
    Vector3 from{}, to{};
    for (int c = 0; c < D; ++c) {
      T &v = chunk.motion[c * chunk_size<T> + p], &way = advection[c * chunk_size<T> + p];
      from[c] = v;
      if (scene_.experiment.grips[grip].held[c]) v = way = static_cast<T>(told[c]);
      to[c] = v;
    }
    given[grip].add(chunk.body.mass * (around ? double(around[p]) : 1.0), place_of(chunk, p), from, to);
  }
}

template <int D, class T, class Components>
void ParticleStep<D, T, Components>::clear_given_to_gripped() {
  given_to_gripped_.resize(particles_.size());
  for (std::size_t body = 0; body < particles_.size(); ++body)
    given_to_gripped_[body].assign(particles_[body].blocks.size() * grips_.size(), {});
}

/// Sums block by block, whatever the number of threads.
template <int D, class T, class Components>
GivenToGripped ParticleStep<D, T, Components>::given_to_gripped(std::size_t grip) const {
  GivenToGripped sum;
  for (const auto& of_body : given_to_gripped_)
    for (std::size_t k = grip; k < of_body.size(); k += grips_.size()) sum.add(of_body[k]);
  return sum;
}

}  // namespace mpm::cpu
