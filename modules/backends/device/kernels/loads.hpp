#pragma once
// Forces from outside: those on all the mass of a body, and those at points, which the particles beside them carry.

#include "backends/device/kernels/formulas.hpp"
#include "backends/device/kernels/scatter.hpp"

namespace mpm::device {

template <class Scene>
inline constexpr int load_scalars = Scene::dimension* Tile<Scene::dimension>::nodes;

/// Scatters w m a(x, X, t) of the forces per mass.
template <class Scene>
MPM_HD void scatter_body_force(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  constexpr int D = Scene::dimension;
  T* channel[D];
  for (int c = 0; c < D; ++c) channel[c] = a.grid.field[Scene::Node::body_force] + c * a.node_count;
  scatter_blocks<Scene, D>(team, a, channel, [&](int p, auto add) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return;  // the scatter has reported it
    const FormulaPlace<Scene> place(a.particles, p);
    const Vec<D, T> pull = Scene::acceleration(a.particles.body, place.x, place.X, a.formula_numbers);
    if (!all_finite(pull)) return report(a, p);
    const T mass = of_size<Scene>(a.particles, a.particles.mass, p);
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      T values[D];
      for (int i = 0; i < D; ++i) values[i] = s.weight * (mass * pull[i]);
      add(s.node, values);
    });
  });
}

/// Adds what the loads of the kind a.load_kind give by a particle; returns false where one of them is not finite.
template <class Scene, int D, class T>
MPM_HD bool add_loads(const Arguments<T>& a, int p, GivenByLoads<D, T>& sum) {
  using P = typename Scene::Particle;
  const int stride = a.particles.stride;
  const FormulaPlace<Scene> particle(a.particles, p);
  const Mat<D, T> F = load_matrix<D>(a.particles.field[P::deformation], stride, p);
  for (int k = a.particles.loads.first[p]; k < a.particles.loads.first[p + 1]; ++k) {
    const LoadShare<T>& share = a.particles.loads.shares[k];
    const LoadLaw<T>& law = a.load_laws[share.load];
    if (!(law.gives >> a.load_kind & 1)) continue;
    const SharePlace<D, T> place(share, particle.x, particle.X, F);
    Vec<D, T> value;
    if (law.action == load_of_spring) {
      value = a.dashpots ? dashpot_force(law.damping, load<D>(a.particles.field[P::velocity], stride, p))
                         : spring_force(law.stiffness, share, place, particle.x, particle.X);
    } else {
      value = Scene::load_value(share.load, place.x, place.X, a.formula_numbers);
      if (!all_finite(value)) return false;
    }
    if (law.action == load_of_pressure || law.action == load_of_follower) {
      const bool follower = law.action == load_of_follower;
      add_pressure(share, place, particle.x, F, value[0], follower, follower && Scene::axisymmetric, sum);
    } else {
      add_force(share, place, value, sum);
    }
  }
  return true;
}

/// Scatters w b + S grad w of the loads of the kind a.load_kind to the field of nodes `a.load_field`.
template <class Scene>
MPM_HD void scatter_load(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  constexpr int D = Scene::dimension;
  T* channel[D];
  for (int c = 0; c < D; ++c) channel[c] = a.grid.field[a.load_field] + c * a.node_count;
  scatter_blocks<Scene, D>(team, a, channel, [&](int p, auto add) {
    if (a.particles.loads.first[p] == a.particles.loads.first[p + 1]) return;
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return;  // the scatter has reported it
    GivenByLoads<D, T> given;
    if (!add_loads<Scene>(a, p, given)) return report(a, p);
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      T values[D];
      for (int i = 0; i < D; ++i) {
        values[i] = s.weight * given.b[i];
        for (int j = 0; j < D; ++j) values[i] += given.S(i, j) * s.gradient[j];
      }
      add(s.node, values);
    });
  });
}

}  // namespace mpm::device
