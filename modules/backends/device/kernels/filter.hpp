#pragma once
// The filter's loop over the grid's velocity applies S+ S to the increment by the transfer's own gather and scatter,
// then the functor's update at every node.

#include "backends/device/kernels/gather.hpp"
#include "backends/device/kernels/grid.hpp"
#include "backends/device/kernels/scatter.hpp"
#include "backends/device/kernels/sums.hpp"
#include "operators/filter.hpp"

namespace mpm::device {

/// Sets increment <- velocity, at ghosts too.
template <class Scene>
MPM_HD void begin_filter(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  for_each_component<Scene::dimension>(team, a,
                                       [&](int at) { a.grid.field[N::increment][at] = a.grid.field[N::velocity][at]; });
}

template <class Scene>
MPM_HD void clear_projection(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_component<Scene::dimension>(team, a, [&](int at) { a.grid.field[Scene::Node::projection][at] = T(0); });
}

template <class Scene>
inline constexpr int project_scalars = Scene::dimension* Tile<Scene::dimension>::nodes;

/// Computes the momentum of S+ S increment: the transfer gathers the increment on scratch and scatters what it made of
/// it. Particles are not changed.
template <class Scene>
MPM_HD void project(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Transfer = typename Scene::Transfer;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  T* channel[D];
  for (int c = 0; c < D; ++c) channel[c] = a.grid.field[N::projection] + c * a.node_count;
  scatter_blocks<Scene, D>(team, a, channel, [&](int p, auto add) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    const T mass = of_size<Scene>(a.particles, a.particles.mass, p);
    auto moments = gathered_moments<Scene>(a, stencil, a.grid.field[N::increment], nullptr);
    moments.velocity_increment = moments.velocity;
    const auto parameters = parameters_of<Transfer>(a.transfer_parameters);
    typename Transfer::template State<D, T> state{};
    Vec<D, T> v{}, advection, b{};
    Mat<D, T> A{};
    Transfer::gather(parameters, moments, a.dt, v, state, advection);
    Transfer::scatter(parameters, mass, v, state, b, A);
    [[maybe_unused]] auto higher = higher_of<Scene>(a, stencil, p);
    if constexpr (Scene::basis_functions > 0) {
      for (T& coefficient : higher.coefficient) coefficient = T(0);
      higher.gather(a, a.grid.field[N::increment]);
    }
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      T values[D];
      for (int i = 0; i < D; ++i) {
        T momentum = b[i];
        if constexpr (Scene::scatters_affine)
          for (int j = 0; j < D; ++j) momentum += A(i, j) * s.distance[j];
        values[i] = s.weight * momentum;
        if constexpr (Scene::basis_functions > 0) values[i] += mass * higher.given(s.node, i);
      }
      add(s.node, values);
    });
  });
}

/// Folds the projection as the momenta of this step were folded.
template <class Scene>
MPM_HD void fold_projection(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  using F = NodeField<N::projection, Scene::dimension, rule_momentum, never_folded, false, -1>;
  for_each_line<Scene>(team, a, [&](int line, double* sums) {
    for_each_fold_of_line(a, line, true, false, [&](const Fold& fold) {
      if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
      const auto mass = a.grid.field[N::folded_mass][fold.ghost];
      note_image<Scene>(
          a, fold, mass, [&](int c) { return a.grid.field[N::projection][c * a.node_count + fold.ghost]; }, sums);
      fold_field<F>(a, fold, mass);
    });
  });
}

/// Applies the functor's update at every node with mass. The velocity before conditions and contact is kept where they
/// act on every increment.
template <class Scene>
MPM_HD void update_filter(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Filter = typename Scene::Filter;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  for_each_node(team, a, [&](int node) {
    const int nodes = a.node_count;
    const T mass = a.grid.field[N::mass][node];
    if (!(mass > T(0))) return;
    Vec<D, T> projected = load<D>(a.grid.field[N::projection], nodes, node);
    for (int c = 0; c < D; ++c) projected[c] = velocity_of(projected[c], mass);
    Vec<D, T> increment = load<D>(a.grid.field[N::increment], nodes, node);
    Vec<D, T> velocity = load<D>(a.grid.field[N::velocity], nodes, node);
    Filter::update(parameters_of<Filter>(a.filter_parameters), a.iteration, projected, increment, velocity);
    store(a.grid.field[N::increment], nodes, node, increment);
    if constexpr (N::filter_impulse >= 0)
      for (int c = 0; c < D && a.records; ++c)
        a.grid.field[N::filter_impulse][c * nodes + node] +=
            mass * (velocity[c] - a.grid.field[N::velocity][c * nodes + node]);
    store(a.grid.field[N::velocity], nodes, node, velocity);
    if constexpr (N::trial_velocity >= 0) store(a.grid.field[N::trial_velocity], nodes, node, velocity);
  });
}

/// Adds to the increment what conditions and contact have changed, at nodes with mass.
template <class Scene>
MPM_HD void correct_increment(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  if constexpr (N::trial_velocity >= 0)
    for_each_component<Scene::dimension>(team, a, [&](int at) {
      T& increment = a.grid.field[N::increment][at];
      if (a.grid.field[N::mass][at % a.node_count] > T(0))
        increment = corrected_increment(increment, a.grid.field[N::velocity][at], a.grid.field[N::trial_velocity][at]);
    });
}

/// Sets velocity_of_constraints to the velocity without what conditions and contact have added in this step.
template <class Scene>
MPM_HD void keep_free_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  if constexpr (N::velocity_of_constraints >= 0)
    for_each_component<Scene::dimension>(team, a, [&](int at) {
      T& added = a.grid.field[N::velocity_of_constraints][at];
      const T velocity = a.grid.field[N::velocity][at];
      added = a.after_forces ? without(velocity, added) : velocity;
    });
}

/// Notes that the filter's loop takes back what conditions and contact have given this component so far; the rest of
/// what they have added came with the filter's correction.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void note_taken_back(const Arguments<T>& a, int at) {
  using N = typename Scene::Node;
  if constexpr (N::filter_impulse >= 0) {
    if (!a.records) return;
    T of_filter = a.grid.field[N::mass][at % a.node_count] * a.grid.field[N::velocity_of_constraints][at];
    if constexpr (N::standing_boundary_impulse >= 0) {
      T& standing = a.grid.field[N::standing_boundary_impulse][at];
      a.grid.field[N::boundary_impulse][at] -= standing;
      of_filter -= standing, standing = T(0);
    }
    if constexpr (N::standing_contact_impulse >= 0) {
      T& standing = a.grid.field[N::standing_contact_impulse][at];
      a.grid.field[N::contact_impulse][at] -= standing;
      of_filter -= standing, standing = T(0);
    }
    a.grid.field[N::filter_impulse][at] -= of_filter;
  }
}

/// Sets velocity and velocity_of_constraints to the velocity without what conditions and contact have added, so that an
/// impulse which the increments no longer need is taken back.
template <class Scene>
MPM_HD void take_free_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  if constexpr (N::velocity_of_constraints >= 0)
    for_each_component<Scene::dimension>(team, a, [&](int at) {
      T &added = a.grid.field[N::velocity_of_constraints][at], &velocity = a.grid.field[N::velocity][at];
      if (!(a.grid.field[N::mass][at % a.node_count] > T(0))) return;
      note_taken_back<Scene>(a, at);
      added = velocity = without(velocity, added);
    });
}

/// Sets velocity_of_constraints to what conditions and contact have added since.
template <class Scene>
MPM_HD void measure_constraints(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  if constexpr (N::velocity_of_constraints >= 0)
    for_each_component<Scene::dimension>(team, a, [&](int at) {
      T& added = a.grid.field[N::velocity_of_constraints][at];
      if (a.grid.field[N::mass][at % a.node_count] > T(0)) added = without(a.grid.field[N::velocity][at], added);
    });
}

/// Gives ghosts the mirrored increment: a difference of velocities, which walls mirror as if they were at rest.
template <class Scene>
MPM_HD void fill_increments(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_fold(team, a, false, false, [&](const Fold& fold) {
    if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
    for (int c = 0; c < Scene::dimension; ++c) {
      T* const increment = a.grid.field[Scene::Node::increment] + c * a.node_count;
      increment[fold.ghost] = mirrored(increment[fold.mirror], T(mirror_sign(fold.wall, fold.axis, c)), T(0));
    }
  });
}

/// Calls visit(field, kept) for a velocity and what conditions and contact have added to it, each with its copy before
/// the filter, component by component.
template <class Scene, class Visit>
MPM_HD void for_each_kept(const Team& team, const Arguments<typename Scene::Scalar>& a, Visit visit) {
  using N = typename Scene::Node;
  if constexpr (N::unfiltered_velocity >= 0)
    for_each_component<Scene::dimension>(team, a, [&](int at) {
      visit(a.grid.field[N::velocity][at], a.grid.field[N::unfiltered_velocity][at]);
      if constexpr (N::unfiltered_velocity_of_constraints >= 0)
        visit(a.grid.field[N::velocity_of_constraints][at], a.grid.field[N::unfiltered_velocity_of_constraints][at]);
    });
}

/// Keeps the velocity before the filter for a pass that restores it.
template <class Scene>
MPM_HD void keep_unfiltered(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_kept<Scene>(team, a, [](const T& velocity, T& kept) { kept = velocity; });
}

/// Restores the velocity that keep_unfiltered kept.
template <class Scene>
MPM_HD void restore_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_kept<Scene>(team, a, [](T& velocity, const T& kept) { velocity = kept; });
}

/// Restores the velocity, and keeps in its place what the filter added (XPIC).
template <class Scene>
MPM_HD void keep_correction(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_kept<Scene>(team, a, [](T& velocity, T& kept) {
    const T filtered = velocity;
    velocity = kept;
    kept = without(filtered, velocity);
  });
}

/// Adds the kept correction to the velocity, which gives what the particles take.
template <class Scene>
MPM_HD void add_correction(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  if constexpr (N::filter_impulse >= 0 && N::unfiltered_velocity >= 0)
    for_each_component<Scene::dimension>(team, a, [&](int at) {
      if (!a.records) return;
      a.grid.field[N::filter_impulse][at] +=
          a.grid.field[N::mass][at % a.node_count] * a.grid.field[N::unfiltered_velocity][at];
    });
  for_each_kept<Scene>(team, a, [](T& velocity, const T& kept) { velocity += kept; });
}

/// Sums m increment . increment.
template <class Scene>
MPM_HD void increment_norm(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over_nodes<1>(team, a, [&](int node, double* sum) {
    for (int c = 0; c < Scene::dimension; ++c)
      sum[0] += mass_norm_term(double(a.grid.field[N::mass][node]),
                               double(a.grid.field[N::increment][c * a.node_count + node]));
  });
}

}  // namespace mpm::device
