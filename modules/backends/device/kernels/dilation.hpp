#pragma once
// Averages against locking: particles give nodes their mean stresses, and how the grid's velocity changes their volumes;
// nodes average both by volume, and particles take the averages for their own. The formulas are those of
// operators/dilation.hpp. This file is compiled only for scenes that average.

#include "backends/device/kernels/gather.hpp"
#include "backends/device/kernels/grid.hpp"
#include "backends/device/kernels/scatter.hpp"
#include "operators/dilation.hpp"

namespace mpm::device {

// ---- what both averages do -----------------------------------------------------------------------------------------

/// The channels: a sum by volume, and the volume.
template <class Scene>
inline constexpr int mean_scalars = 2 * Tile<Scene::dimension>::nodes;

template <int sum, int volume, class T>
MPM_HD void clear_sums(const Team& team, const Arguments<T>& a) {
  for_each_node(team, a, [&](int node) { a.grid.field[sum][node] = a.grid.field[volume][node] = T(0); });
}

/// Gives w V and w V times a value to the nodes, V the current volume of a particle.
template <class Scene, class Stencil, class Add, class T = typename Scene::Scalar>
MPM_HD void give_by_volume(const Arguments<T>& a, const Stencil& stencil, int p, T value, Add add) {
  const T volume = volume_of_particle<Scene>(a.particles, p);
  stencil.for_each_node(a, [&](const StencilNode<Scene::dimension, T>& s) {
    const T share = s.weight * volume;
    const T values[2] = {share * value, share};
    add(s.node, values);
  });
}

/// Adds both sums of ghosts along a.axis to their mirrors, along the folds that the masses made.
template <int sum, int volume, class T>
MPM_HD void fold_sums(const Team& team, const Arguments<T>& a) {
  for_each_fold(team, a, true, false, [&](const Fold& fold) {
    if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
    fold_field<NodeField<sum, 1, rule_even, never_folded, false, -1>>(a, fold, T(0));
    fold_field<NodeField<volume, 1, rule_even, never_folded, false, -1>>(a, fold, T(0));
  });
}

/// Computes the average at a node, which is 0 where there are no particles.
template <int sum, int volume, int mean, class T>
MPM_HD void divide_sums(const Team& team, const Arguments<T>& a) {
  for_each_node(team, a, [&](int node) {
    const T of_node = a.grid.field[volume][node];
    a.grid.field[mean][node] = of_node > T(0) ? a.grid.field[sum][node] / of_node : T(0);
  });
}

/// Gives ghosts along a.axis the average of their mirrors.
template <int mean, class T>
MPM_HD void fill_means(const Team& team, const Arguments<T>& a) {
  for_each_fold(team, a, false, false, [&](const Fold& fold) {
    if (a.grid.folded[fold.ghost] >> fold.axis & 1) a.grid.field[mean][fold.ghost] = a.grid.field[mean][fold.mirror];
  });
}

/// Calls body(p, average at particle p).
template <class Scene, int mean, class Body>
MPM_HD void gather_means(const Team& team, const Arguments<typename Scene::Scalar>& a, Body body) {
  using T = typename Scene::Scalar;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.particles.count, [&](int p) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    T value = T(0);
    stencil.for_each_node(
        a, [&](const StencilNode<D, T>& s) { value += s.weight * a.grid.field[mean][node_index<D>(a, s.node)]; });
    body(p, value);
  });
}

#define MPM_DEVICE_AVERAGE(mean, sum, volume)                                               \
  template <class Scene>                                                                    \
  MPM_HD void clear_##mean(const Team& team, const Arguments<typename Scene::Scalar>& a) {  \
    clear_sums<Scene::Node::sum, Scene::Node::volume>(team, a);                             \
  }                                                                                         \
  template <class Scene>                                                                    \
  MPM_HD void fold_##mean(const Team& team, const Arguments<typename Scene::Scalar>& a) {   \
    fold_sums<Scene::Node::sum, Scene::Node::volume>(team, a);                              \
  }                                                                                         \
  template <class Scene>                                                                    \
  MPM_HD void divide_##mean(const Team& team, const Arguments<typename Scene::Scalar>& a) { \
    divide_sums<Scene::Node::sum, Scene::Node::volume, Scene::Node::mean>(team, a);         \
  }                                                                                         \
  template <class Scene>                                                                    \
  MPM_HD void fill_##mean(const Team& team, const Arguments<typename Scene::Scalar>& a) {   \
    fill_means<Scene::Node::mean>(team, a);                                                 \
  }
MPM_DEVICE_AVERAGE(mean_stress, volume_stress, stressed_volume)
MPM_DEVICE_AVERAGE(dilation, volume_rate, strained_volume)
#undef MPM_DEVICE_AVERAGE

// ---- mean stress -----------------------------------------------------------------------------------------------

/// In how many directions a dilation strains: z stays as it is in plane strain.
template <class Scene>
inline constexpr int dilated_directions = Scene::dimension == 2 && !Scene::axisymmetric ? 2 : 3;

/// The mean of the normal Kirchhoff stresses in these directions, Pa.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T mean_normal_stress(const ParticleArrays<T>& particles, int p) {
  const T* const stress = particles.field[Scene::Particle::stress];
  T sum = stress[p];
  for (int k = 1; k < dilated_directions<Scene>; ++k) sum += stress[k * particles.stride + p];
  return sum * T(1.0 / dilated_directions<Scene>);
}

/// Scatters w V and w V times the mean Cauchy stress.
template <class Scene>
MPM_HD void scatter_mean_stress(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  T* channel[2] = {a.grid.field[N::volume_stress], a.grid.field[N::stressed_volume]};
  scatter_blocks<Scene, 2>(team, a, channel, [&](int p, auto add) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    const T J = a.particles.field[Scene::Particle::volume_ratio][p];
    give_by_volume<Scene>(a, stencil, p, mean_normal_stress<Scene>(a.particles, p) / J, add);
  });
}

/// Replaces the mean of each particle's normal stresses by the nodes'.
template <class Scene>
MPM_HD void take_mean_stress(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using P = typename Scene::Particle;
  gather_means<Scene, Scene::Node::mean_stress>(team, a, [&](int p, T cauchy) {
    const T change = a.particles.field[P::volume_ratio][p] * cauchy - mean_normal_stress<Scene>(a.particles, p);
    for (int k = 0; k < dilated_directions<Scene>; ++k)
      a.particles.field[P::stress][k * a.particles.stride + p] += change;
  });
}

// ---- dilation --------------------------------------------------------------------------------------------------

/// Scatters w V and w V times the dilation.
template <class Scene>
MPM_HD void scatter_dilation(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  T* channel[2] = {a.grid.field[N::volume_rate], a.grid.field[N::strained_volume]};
  scatter_blocks<Scene, 2>(team, a, channel, [&](int p, auto add) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    const auto moments = gathered_moments<Scene>(a, stencil, a.grid.field[N::velocity], nullptr);
    const Mat<D, T> L = Scene::strain_by_affine ? moments.affine : moments.velocity_gradient;
    T dilation;
    if constexpr (Scene::axisymmetric)
      dilation = dilation_of(
          Deformation<2, T>{L, moments.velocity[0] / a.particles.field[Scene::Particle::position][p]}, a.dt);
    else
      dilation = dilation_of(L, a.dt);
    give_by_volume<Scene>(a, stencil, p, dilation, add);
  });
}

template <class Scene>
MPM_HD void gather_dilation(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  gather_means<Scene, Scene::Node::dilation>(
      team, a, [&](int p, T mean) { a.particles.field[Scene::Particle::mean_dilation][p] = mean; });
}

}  // namespace mpm::device
