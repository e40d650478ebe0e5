#pragma once
// Particles to grid. One team sums a block's particles into a tile in shared memory, then adds the tile to the grid.

#include "backends/device/kernels/higher.hpp"

namespace mpm::device {

/// Nodes of a block and of the stencils of its particles: one before it, two behind. A list may reach farther.
template <int D>
struct Tile {
  static constexpr int before = 1, side = block_cells + 3, nodes = D == 2 ? side * side : side * side * side;

  /// Index of a node in the tile, or -1.
  MPM_HD static int index(const int* first_cell, const int* node) {
    int index = 0;
    for (int c = D - 1; c >= 0; --c) {
      const int at = node[c] - first_cell[c] + before;
      if (at < 0 || at >= side) return -1;
      index = index * side + at;
    }
    return index;
  }
  MPM_HD static void coordinates(const int* first_cell, int index, int* node) {
    for (int c = 0; c < D; ++c, index /= side) node[c] = first_cell[c] - before + index % side;
  }
};

/// Sums over the particles of the team's block. `contribute(p, add)` calls add(node, values[Channels]);
/// `channel(k)` is the grid's array of channel k, or null where nothing is given to it.
template <int D, int Channels, class T, class Contribute, class Channel>
MPM_HD void scatter_block(const Team& team, const Arguments<T>& a, Contribute contribute, Channel channel) {
  T* const tile = team.template shared<T>();
  const int* const first_cell = a.blocks.cell + 3 * team.block();
  team.for_each_lane([&](int lane) {
    for (int k = lane; k < Channels * Tile<D>::nodes; k += team.lanes()) tile[k] = T(0);
  });
  team.for_each_lane([&](int lane) {
    const int end = a.blocks.begin[team.block() + 1];
    for (int i = a.blocks.begin[team.block()] + lane; i < end; i += team.lanes())
      contribute(a.blocks.order[i], [&](const int* node, const T* values) {
        const int at = Tile<D>::index(first_cell, node);
        for (int k = 0; k < Channels; ++k) {
          T* const grid = channel(k);
          if (!grid) continue;
          Team::add(at >= 0 ? tile + k * Tile<D>::nodes + at : grid + node_index<D>(a, node), values[k]);
        }
      });
  });
  team.for_each_lane([&](int lane) {
    for (int at = lane; at < Tile<D>::nodes; at += team.lanes())
      for (int k = 0; k < Channels; ++k) {
        const T value = tile[k * Tile<D>::nodes + at];
        if (value == T(0)) continue;  // nodes outside the grid are among these
        int node[D];
        Tile<D>::coordinates(first_cell, at, node);
        Team::add(channel(k) + node_index<D>(a, node), value);
      }
  });
}

/// Mass, momentum, force; with contact also volume, its gradient and the surface's position.
template <class Scene>
inline constexpr int scatter_channels = (1 + 2 * Scene::dimension) * (Scene::contact ? 2 : 1);
template <class Scene>
inline constexpr int scatter_scalars = scatter_channels<Scene>* Tile<Scene::dimension>::nodes;

/// The grid's array of a channel, null where this scatter leaves it alone.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T* scatter_channel(const Arguments<T>& a, int k) {
  constexpr int D = Scene::dimension;
  const int nodes = a.node_count;
  const bool weight = a.momentum && !a.remap;
  if (k == 0) return a.momentum ? a.grid.mass : nullptr;
  if (k < 1 + D) return a.momentum ? a.grid.momentum + (k - 1) * nodes : nullptr;
  if (k < 1 + 2 * D) return a.force || weight ? a.grid.force + (k - 1 - D) * nodes : nullptr;
  if (!a.contact_fields) return nullptr;
  if (k == 1 + 2 * D) return a.grid.volume;
  if (k < 2 + 3 * D) return a.grid.volume_gradient + (k - 2 - 2 * D) * nodes;
  return a.grid.mass_position + (k - 2 - 3 * D) * nodes;
}

/// Mass or volume of a particle, given what the body says.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T of_ring(const ParticleArrays<T>& particles, T of_body, int p) {
  if constexpr (Scene::axisymmetric) return of_body * particles.circumference[p];
  return of_body;
}

/// The particle's polynomials beyond affine where the scene has them.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto higher_of(const Arguments<T>& a, const Stencil<Scene>& stencil, int p) {
  if constexpr (Scene::basis_functions > 0) {
    Higher<Scene> higher(stencil);
    higher.load(a.particles.transfer_state, a.particles.stride, p);
    return higher;
  } else {
    return 0;
  }
}

/// Scatter pass: w m, w (b + A d), -V0 tau grad w (or w D^-1 d) and w m g, and the contact channels, as `a` says.
/// Around an axis -w V0 tau_zz / r too.
template <class Scene>
MPM_HD void scatter(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Transfer = typename Scene::Transfer;
  constexpr int D = Scene::dimension;
  scatter_block<D, scatter_channels<Scene>>(
      team, a,
      [&](int p, auto add) {
        const Stencil<Scene> stencil(a, p);
        if (!stencil.inside()) return Team::lower(a.first_failed, p);
        const ParticleArrays<T>& particles = a.particles;
        Vec<D, T> b{};
        Mat<D, T> A{};
        Sym<D, T> tau{};
        const T mass_of_particle = of_ring<Scene>(particles, particles.mass, p);
        const T volume_of_particle = of_ring<Scene>(particles, particles.volume, p);
        if (a.momentum)
          Transfer::scatter(
              parameters_of<Transfer>(a.transfer_parameters), mass_of_particle,
              load<D>(particles.velocity, particles.stride, p),
              load_state<typename Transfer::template State<D, T>>(particles.transfer_state, particles.stride, p), b, A);
        if (a.force)
          for (int k = 0; k < Sym<D, T>::size; ++k) tau.s[k] = particles.stress[k * particles.stride + p];
        const bool weighs = a.momentum && !a.remap;
        [[maybe_unused]] const auto higher = higher_of<Scene>(a, stencil, p);
        stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
          T values[scatter_channels<Scene>];
          const T mass = s.weight * mass_of_particle;
          values[0] = mass;
          for (int i = 0; i < D; ++i) {
            T momentum = b[i];
            if constexpr (Scene::scatters_affine)
              for (int j = 0; j < D; ++j) momentum += A(i, j) * s.distance[j];
            T traction = 0;
            for (int j = 0; j < D; ++j)
              if constexpr (Scene::stress_by_affine)
                traction += tau(i, j) * s.affine[j];
              else
                traction += tau(i, j) * s.gradient[j];
            values[1 + i] = s.weight * momentum;
            if constexpr (Scene::basis_functions > 0) values[1 + i] += mass_of_particle * higher.given(s.node, i);
            values[1 + D + i] = (weighs ? mass * a.gravity[i] : T(0)) - volume_of_particle * traction;
          }
          if constexpr (Scene::axisymmetric)
            values[1 + D] -= s.weight * volume_of_particle * tau.s[2] / particles.position[p];
          if constexpr (Scene::contact) {
            const T volume = a.contact_fields ? volume_of_particle * particles.volume_ratio[p] : T(0);
            T section = volume;  // a ring's volume grows away from the axis
            if constexpr (Scene::axisymmetric) section = volume / (T(6.283185307179586) * particles.position[p]);
            values[1 + 2 * D] = s.weight * volume;
            for (int i = 0; i < D; ++i) {
              values[2 + 2 * D + i] = section * s.gradient[i];
              values[2 + 3 * D + i] = -mass * s.distance[i];
            }
          }
          add(s.node, values);
        });
      },
      [&](int k) { return scatter_channel<Scene>(a, k); });
}

}  // namespace mpm::device
