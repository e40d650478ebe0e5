#pragma once
// Lets nodes know of particles that a grip moves.

#include "backends/device/kernels/scatter.hpp"

namespace mpm::device {

template <class Scene>
inline constexpr int scatter_grip_scalars = (2 * Scene::dimension + 1) * Tile<Scene::dimension>::nodes;

/// Scatters the mass of the particles of a.grip, the momentum that they are told to have at the end of the step, and the
/// one that they have.
template <class Scene>
MPM_HD void scatter_grip(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  if constexpr (P::grip >= 0) {
    const GripArrays<T>& grip = a.grips[a.grip];
    T* channel[2 * D + 1];
    for (int c = 0; c < D; ++c)
      channel[c] = grip.momentum + c * a.node_count, channel[D + c] = grip.before + c * a.node_count;
    channel[2 * D] = grip.mass;
    scatter_blocks<D, 2 * D + 1>(team, a, channel, [&](int p, auto add) {
      if (int(a.particles.field[P::grip][p]) != a.grip + 1) return;
      const Stencil<Scene> stencil(a, p);
      if (!stencil.inside()) return Team::lower(a.first_failed, p);
      const T mass_of_particle = of_size<Scene>(a.particles, a.particles.mass, p);
      const int stride = a.particles.stride;
      stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
        T values[2 * D + 1];
        const T mass = s.weight * mass_of_particle;
        for (int c = 0; c < D; ++c) {
          values[c] = mass * a.particles.field[P::told_velocity][c * stride + p];
          values[D + c] = mass * a.particles.field[P::velocity][c * stride + p];
        }
        values[2 * D] = mass;
        add(s.node, values);
      });
    });
  }
}

}  // namespace mpm::device
