#pragma once
// Takes particles to the grid: a team sums a block's particles into a tile in shared memory, then adds it to the grid.

#include "backends/device/kernels/exact_sums.hpp"
#include "backends/device/kernels/higher.hpp"
#include "operators/contact_geometry.hpp"

namespace mpm::device {

/// The nodes of a block and of its particles' stencils: one before it, two behind. A list may reach farther.
template <int D>
struct Tile {
  static constexpr int before = 1, side = block_cells + 3, nodes = D == 2 ? side * side : side * side * side;

  /// The index of a node in the tile, or -1.
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

/// The shared memory that every device gives a team without being asked for more, bytes.
inline constexpr int shared_bytes = 48 * 1024;

/// How many of the channels of a scatter have a tile at the same time: all of them, where there is room.
template <int D, int Channels, class T>
inline constexpr int channels_together = Channels* Tile<D>::nodes* static_cast<int>(sizeof(T)) <= shared_bytes
                                             ? Channels
                                             : shared_bytes / (Tile<D>::nodes * static_cast<int>(sizeof(T)));

/// Notes that the nodes of the row-th row of a block's tile are active. A tile may reach beyond the grid.
template <int D, class T>
MPM_HD void note_row(const Arguments<T>& a, const int* first_cell, int row) {
  int node[D];
  Tile<D>::coordinates(first_cell, row * Tile<D>::side, node);
  for (int c = 0; c < D; ++c)
    if (node[c] >= a.extent[c] - a.padding[c] || (c > 0 && node[c] < -a.padding[c])) return;
  const int last_of_grid = a.extent[0] - a.padding[0] - 1, last_of_tile = node[0] + Tile<D>::side - 1;
  if (node[0] < -a.padding[0]) node[0] = -a.padding[0];
  const int count = (last_of_tile < last_of_grid ? last_of_tile : last_of_grid) - node[0] + 1;
  const int begin = node_index<D>(a, node), end = begin + count;
  for (int at = begin; at < end; at = (at / nodes_of_run + 1) * nodes_of_run) note_active(a.grid, at);
}

/// Sums over the particles of each block, which are visited once more for channels that find no room. `contribute(p, add)`
/// calls add(node, values[Channels]); `channel[k]` is the grid's array of channel k, or null where nothing is given to it.
template <int D, int Channels, class T, class Contribute>
MPM_HD void scatter_block(const Team& team, const Arguments<T>& a, int block, T* const* channel,
                          Contribute& contribute) {
  constexpr int together = channels_together<D, Channels, T>;
  T* const tile = team.template shared<T>();
  const int* const first_cell = a.blocks.cell + 3 * block;
  for (int first = 0; first < Channels; first += together) {
    const int count = Channels - first < together ? Channels - first : together;
    team.for_each_lane([&](int lane) {
      for (int k = lane; k < count * Tile<D>::nodes; k += team.lanes()) tile[k] = T(0);
      if (first > 0) return;
      for (int row = lane; row < Tile<D>::nodes / Tile<D>::side; row += team.lanes()) note_row<D>(a, first_cell, row);
    });
    team.for_each_lane([&](int lane) {
      const int end = a.blocks.begin[block + 1];
      for (int i = a.blocks.begin[block] + lane; i < end; i += team.lanes())
        contribute(a.blocks.order[i], [&](const int* node, const T* values) {
          const int at = Tile<D>::index(first_cell, node);
          if (at < 0) note_active(a.grid, node_index<D>(a, node));
          for (int k = 0; k < count; ++k) {
            T* const to = channel[first + k];
            if (to)
              Team::add(at >= 0 ? tile + k * Tile<D>::nodes + at : to + node_index<D>(a, node), values[first + k]);
          }
        });
    });
    team.for_each_lane([&](int lane) {
      for (int at = lane; at < Tile<D>::nodes; at += team.lanes())
        for (int k = 0; k < count; ++k) {
          const T value = tile[k * Tile<D>::nodes + at];
          if (value == T(0)) continue;  // nodes outside the grid are among these
          int node[D];
          Tile<D>::coordinates(first_cell, at, node);
          Team::add(channel[first + k] + node_index<D>(a, node), value);
        }
    });
  }
}
template <class Scene, int Channels, class T, class Contribute>
MPM_HD void scatter_blocks(const Team& team, const Arguments<T>& a, T* const* channel, Contribute contribute) {
  constexpr int D = Scene::dimension;
  if constexpr (Scene::deterministic) {
    if (a.exact_phase == exact_take) return take_exact_sums<Channels>(team, a, channel);
    for_each_block(team, a, [&](int block) {
      if (a.exact_phase == exact_measure)
        measure_block<Channels>(team, a, block, channel, contribute);
      else
        add_block_exactly<D, Channels>(team, a, block, channel, contribute);
    });
  } else {
    for_each_block(team, a, [&](int block) { scatter_block<D, Channels>(team, a, block, channel, contribute); });
  }
}

template <class Scene>
inline constexpr int scatter_scalars =
    channels_together<Scene::dimension, Scene::scattered, typename Scene::Scalar>* Tile<Scene::dimension>::nodes;

/// Finds the grid's arrays of what particles give, one a component; null where this scatter leaves one alone.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void find_channels(const Arguments<T>& a, T** channel) {
  using N = typename Scene::Node;
  Scene::for_each_node_field([&](auto field) {
    using F = decltype(field);
    if constexpr (F::place >= 0) {
      const bool of_momentum = F::number == N::mass || F::number == N::momentum;
      const bool given = of_momentum ? a.momentum : F::folded == folded_with_force ? a.force : a.contact_fields;
      for (int k = 0; k < F::components; ++k)
        channel[F::place + k] = given ? a.grid.field[F::number] + k * a.node_count : nullptr;
    }
  });
}

/// The mass or volume of a particle, given that of one of size 1.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T of_size(const ParticleArrays<T>& particles, T of_body, int p) {
  if constexpr (Scene::Particle::size >= 0) return of_body * particles.field[Scene::Particle::size][p];
  return of_body;
}

/// The volume J V0 of a particle, m^3 (in plane strain for a metre of depth).
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T volume_of_particle(const ParticleArrays<T>& particles, int p) {
  return of_size<Scene>(particles, particles.volume, p) * particles.field[Scene::Particle::volume_ratio][p];
}

/// Scatters w m, w (b + A d), -V0 tau grad w (or w D^-1 d), and the contact fields, as `a` says, around an
/// axis also -w V0 tau_zz / r. Forces without a field of their own go into the momenta, times dt. The weight follows from
/// the masses (weigh).
template <class Scene>
MPM_HD void scatter(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Transfer = typename Scene::Transfer;
  using P = typename Scene::Particle;
  using Place = typename Scene::Place;
  constexpr int D = Scene::dimension;
  constexpr bool merged = Place::force < 0;  // without a field of forces momenta take what these add in the step
  constexpr int of_force = merged ? Place::momentum : Place::force;
  const T force_share = merged ? a.dt : T(1);
  T* channel[Scene::scattered];
  find_channels<Scene>(a, channel);
  scatter_blocks<Scene, Scene::scattered>(team, a, channel, [&](int p, auto add) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    const ParticleArrays<T>& particles = a.particles;
    const int stride = particles.stride;
    [[maybe_unused]] const T* const position = particles.field[P::position];
    Vec<D, T> b{};
    Mat<D, T> A{};
    Sym<D, T> tau{};
    const T mass_of_particle = of_size<Scene>(particles, particles.mass, p);
    const T volume_of_particle = of_size<Scene>(particles, particles.volume, p);
    if (a.momentum)
      Transfer::scatter(parameters_of<Transfer>(a.transfer_parameters), mass_of_particle,
                        load<D>(particles.field[P::velocity], stride, p), transfer_state<Scene>(particles, p), b, A);
    if (a.force)
      for (int k = 0; k < Sym<D, T>::size; ++k) tau.s[k] = particles.field[P::stress][k * stride + p];
    [[maybe_unused]] const auto higher = higher_of<Scene>(a, stencil, p);
    [[maybe_unused]] Mat<D, T> gradient{};  // of the displacement
    if constexpr (Place::mass_displacement >= 0)
      gradient = displacement_gradient(load_matrix<D>(particles.field[P::deformation], stride, p));
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      T values[Scene::scattered] = {};  // values that no formula here knows stay zero
      const T mass = s.weight * mass_of_particle;
      values[Place::mass] = mass;
      if constexpr (Place::mass_state >= 0)
        for (int k = 0; k < Scene::contact_states; ++k) {
          values[Place::mass_state + k] = mass * particles.field[P::contact_state][k * stride + p];
          values[Place::mass_gain + k] = mass * particles.field[P::contact_gain][k * stride + p];
        }
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
        values[Place::momentum + i] = s.weight * momentum;
        if constexpr (Scene::basis_functions > 0)
          values[Place::momentum + i] += mass_of_particle * higher.given(s.node, i);
        values[of_force + i] -= force_share * volume_of_particle * traction;
      }
      if constexpr (Scene::axisymmetric)
        values[of_force] -= force_share * s.weight * volume_of_particle * tau.s[2] / position[p];
      if constexpr (Place::volume_gradient >= 0) {
        const T volume = a.contact_fields ? volume_of_particle * particles.field[P::volume_ratio][p] : T(0);
        T around = T(1);  // a ring's volume and mass grow away from the axis; gradients are those of its section
        if constexpr (Scene::axisymmetric) around = T(6.283185307179586) * position[p];
        for (int i = 0; i < D; ++i) {
          values[Place::volume_gradient + i] = volume / around * s.gradient[i];
          if constexpr (Place::mass_gradient >= 0)
            values[Place::mass_gradient + i] = mass_of_particle / around * s.gradient[i];
          if constexpr (Place::mass_displacement >= 0) {
            T moved = position[i * stride + p] - particles.field[P::initial_position][i * stride + p];
            for (int j = 0; j < D; ++j) moved += gradient(i, j) * s.distance[j];
            values[Place::mass_displacement + i] = mass * moved;
          }
          if constexpr (Place::mass_position >= 0) values[Place::mass_position + i] = -mass * s.distance[i];
        }
      }
      add(s.node, values);
    });
  });
}

}  // namespace mpm::device
