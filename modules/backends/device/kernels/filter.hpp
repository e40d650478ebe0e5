#pragma once
// The filter's loop over the grid's velocity: S+ S of the increment by the transfer's own gather and scatter, then the
// functor's update at every node.

#include "backends/device/kernels/gather.hpp"
#include "backends/device/kernels/grid.hpp"
#include "backends/device/kernels/scatter.hpp"

namespace mpm::device {

/// increment <- velocity, and kept_velocity <- velocity; ghosts too.
template <class Scene>
MPM_HD void begin_filter(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    a.grid.increment[at] = a.grid.kept_velocity[at] = a.grid.velocity[at];
    if (a.grid.constrained) a.grid.kept_constrained[at] = a.grid.constrained[at];
  });
}

template <class Scene>
MPM_HD void clear_projection(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) { a.grid.projected[at] = T(0); });
}

template <class Scene>
inline constexpr int project_scalars = Scene::dimension* Tile<Scene::dimension>::nodes;

/// Momentum of S+ S increment: the transfer gathers the increment on scratch and scatters what it made of it. Particles
/// are not changed.
template <class Scene>
MPM_HD void project(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Transfer = typename Scene::Transfer;
  constexpr int D = Scene::dimension;
  scatter_block<D, D>(
      team, a,
      [&](int p, auto add) {
        const Stencil<Scene> stencil(a, p);
        if (!stencil.inside()) return Team::lower(a.first_failed, p);
        auto moments = gathered_moments<Scene>(a, stencil, a.grid.increment, nullptr);
        moments.velocity_increment = moments.velocity;
        const auto parameters = parameters_of<Transfer>(a.transfer_parameters);
        typename Transfer::template State<D, T> state{};
        Vec<D, T> v{}, advection, b{};
        Mat<D, T> A{};
        Transfer::gather(parameters, moments, a.dt, v, state, advection);
        Transfer::scatter(parameters, a.particles.mass, v, state, b, A);
        [[maybe_unused]] auto higher = higher_of<Scene>(a, stencil, p);
        if constexpr (Scene::basis_functions > 0) {
          for (T& coefficient : higher.coefficient) coefficient = T(0);
          higher.gather(a, a.grid.increment);
        }
        stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
          T values[D];
          for (int i = 0; i < D; ++i) {
            T momentum = b[i];
            if constexpr (Scene::scatters_affine)
              for (int j = 0; j < D; ++j) momentum += A(i, j) * s.distance[j];
            values[i] = s.weight * momentum;
            if constexpr (Scene::basis_functions > 0) values[i] += a.particles.mass * higher.given(s.node, i);
          }
          add(s.node, values);
        });
      },
      [&](int k) { return a.grid.projected + k * a.node_count; });
}

/// Folds the projection as the momenta of this step were folded.
template <class Scene>
MPM_HD void fold_projection(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_fold<Scene::dimension>(team, a, true, false, [&](const Fold& fold) {
    if (a.grid.folded[fold.ghost] >> fold.axis & 1)
      add_mirrored<Scene::dimension>(a.grid.projected, a.node_count, fold, fold.wall, true);
  });
}

/// The functor's update at every node with mass. Leaves p = m v, from which conditions and contact may go on, and the
/// velocity before them in trial_velocity.
template <class Scene>
MPM_HD void update_filter(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Filter = typename Scene::Filter;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.node_count, [&](int node) {
    const int nodes = a.node_count;
    const T mass = a.grid.mass[node];
    if (!(mass > T(0))) return;
    Vec<D, T> projected = load<D>(a.grid.projected, nodes, node);
    for (int c = 0; c < D; ++c) projected[c] = projected[c] / mass;
    Vec<D, T> increment = load<D>(a.grid.increment, nodes, node), velocity = load<D>(a.grid.velocity, nodes, node);
    Filter::update(parameters_of<Filter>(a.filter_parameters), a.iteration, projected, increment, velocity);
    store(a.grid.increment, nodes, node, increment);
    store(a.grid.velocity, nodes, node, velocity);
    store(a.grid.trial_velocity, nodes, node, velocity);
  });
}

/// p = m v.
template <class Scene>
MPM_HD void velocity_to_momentum(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_index(team, Scene::dimension * a.node_count,
                 [&](int at) { a.grid.momentum[at] = a.grid.mass[at % a.node_count] * a.grid.velocity[at]; });
}

/// increment += velocity - trial_velocity, at nodes with mass.
template <class Scene>
MPM_HD void correct_increment(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    if (a.grid.mass[at % a.node_count] > T(0)) a.grid.increment[at] += a.grid.velocity[at] - a.grid.trial_velocity[at];
  });
}

/// constrained <- p / m without what conditions and contact have added in this step.
template <class Scene>
MPM_HD void keep_free_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    const T mass = a.grid.mass[at % a.node_count];
    a.grid.constrained[at] = mass > T(0) ? a.grid.momentum[at] / mass - a.grid.constrained[at] : T(0);
  });
}

/// constrained <- velocity <- velocity without what conditions and contact have added, so that an impulse which the
/// increments no longer need is taken back.
template <class Scene>
MPM_HD void take_free_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    if (a.grid.mass[at % a.node_count] > T(0))
      a.grid.constrained[at] = a.grid.velocity[at] = a.grid.velocity[at] - a.grid.constrained[at];
  });
}

/// constrained <- velocity - constrained: what they have added.
template <class Scene>
MPM_HD void measure_constraints(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    if (a.grid.mass[at % a.node_count] > T(0)) a.grid.constrained[at] = a.grid.velocity[at] - a.grid.constrained[at];
  });
}

/// Gives ghosts the mirrored increment.
template <class Scene>
MPM_HD void fill_increments(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_fold<Scene::dimension>(team, a, false, false, [&](const Fold& fold) {
    if (a.grid.folded[fold.ghost] >> fold.axis & 1)
      take_mirrored<Scene::dimension>(a.grid.increment, a.node_count, fold);
  });
}

/// velocity <- what begin_filter kept, which then keeps what the filter added (XPIC).
template <class Scene>
MPM_HD void keep_correction(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    const typename Scene::Scalar filtered = a.grid.velocity[at];
    a.grid.velocity[at] = a.grid.kept_velocity[at];
    a.grid.kept_velocity[at] = filtered - a.grid.velocity[at];
    if (!a.grid.constrained) return;
    const typename Scene::Scalar added = a.grid.constrained[at];
    a.grid.constrained[at] = a.grid.kept_constrained[at];
    a.grid.kept_constrained[at] = added - a.grid.constrained[at];
  });
}

/// velocity += the kept correction: what the particles take.
template <class Scene>
MPM_HD void add_correction(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    a.grid.velocity[at] += a.grid.kept_velocity[at];
    if (a.grid.constrained) a.grid.constrained[at] += a.grid.kept_constrained[at];
  });
}

/// velocity <- what begin_filter kept.
template <class Scene>
MPM_HD void restore_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    a.grid.velocity[at] = a.grid.kept_velocity[at];
    if (a.grid.constrained) a.grid.constrained[at] = a.grid.kept_constrained[at];
  });
}

/// Lanes of a reduction that shared memory has room for.
inline constexpr int largest_team = 256;

/// partial_sums[team] = sum m increment . increment over the team's nodes.
template <class Scene>
MPM_HD void increment_norm(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  T* const sums = team.template shared<T>();
  team.for_each_lane([&](int lane) {
    const int node = team.block() * team.lanes() + lane;
    T sum = 0;
    if (node < a.node_count)
      for (int c = 0; c < Scene::dimension; ++c) {
        const T v = a.grid.increment[c * a.node_count + node];
        sum += a.grid.mass[node] * v * v;
      }
    sums[lane] = sum;
  });
  team.for_each_lane([&](int lane) {
    if (lane != 0) return;
    T sum = 0;
    for (int k = 0; k < team.lanes(); ++k) sum += sums[k];
    a.partial_sums[team.block()] = sum;
  });
}

}  // namespace mpm::device
