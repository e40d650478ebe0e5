#pragma once
// Mean dilation: particles give nodes how the grid's velocity changes their volumes, nodes average it, and particles
// gather the mean, which `strain` takes instead of their own. The formulas are those of operators/dilation.hpp. This file
// is compiled only for scenes that average.

#include "backends/device/kernels/gather.hpp"
#include "backends/device/kernels/grid.hpp"
#include "backends/device/kernels/scatter.hpp"
#include "backends/device/kernels/sums.hpp"
#include "operators/dilation.hpp"

namespace mpm::device {

template <class Scene>
inline constexpr int scatter_dilation_scalars = 2 * Tile<Scene::dimension>::nodes;

template <class Scene>
MPM_HD void clear_dilation(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_index(team, a.node_count, [&](int node) {
    a.grid.field[N::volume_rate][node] = T(0);
    a.grid.field[N::strained_volume][node] = T(0);
  });
}

/// Scatters w V and w V times the dilation, V the current volume.
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
    const T volume = volume_of_particle<Scene>(a.particles, p);
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      const T share = s.weight * volume;
      const T values[2] = {share * dilation, share};
      add(s.node, values);
    });
  });
}

/// Adds both sums of ghosts along a.axis to their mirrors, along the folds that the masses made.
template <class Scene>
MPM_HD void fold_dilation(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_fold(team, a, true, false, [&](const Fold& fold) {
    if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
    fold_field<NodeField<N::volume_rate, 1, rule_even, never_folded, false, -1>>(a, fold, T(0));
    fold_field<NodeField<N::strained_volume, 1, rule_even, never_folded, false, -1>>(a, fold, T(0));
  });
}

/// Computes the mean dilation of the particles around a node, which is 0 where there are none.
template <class Scene>
MPM_HD void divide_dilation(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_index(team, a.node_count, [&](int node) {
    const T volume = a.grid.field[N::strained_volume][node];
    a.grid.field[N::dilation][node] = volume > T(0) ? a.grid.field[N::volume_rate][node] / volume : T(0);
  });
}

/// Gives ghosts along a.axis the mean of their mirrors.
template <class Scene>
MPM_HD void fill_dilation(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  for_each_fold(team, a, false, false, [&](const Fold& fold) {
    if (a.grid.folded[fold.ghost] >> fold.axis & 1)
      a.grid.field[N::dilation][fold.ghost] = a.grid.field[N::dilation][fold.mirror];
  });
}

template <class Scene>
MPM_HD void gather_dilation(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.particles.count, [&](int p) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    T mean = T(0);
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      mean += s.weight * a.grid.field[N::dilation][node_index<D>(a, s.node)];
    });
    a.particles.field[Scene::Particle::mean_dilation][p] = mean;
  });
}

/// Sums what the last strain, by the mean dilation, took of work more than by each particle's own.
template <class Scene>
MPM_HD void work_of_averaging(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  sum_over<1>(team, a, a.particles.count, [&](int p, double* sum) {
    if constexpr (P::averaged >= 0)
      sum[0] += double(of_size<Scene>(a.particles, a.particles.volume, p)) * a.particles.field[P::averaged][p];
  });
}

}  // namespace mpm::device
