#pragma once
// The material functor on its particles: stress, strain, wave speed. A lane a particle. A particle whose volume ratio
// is not a positive number is reported as failed.

#include "backends/device/kernels/arrays.hpp"

namespace mpm::device {

/// What a particle keeps of its material.
template <class Scene, bool Axisymmetric>
struct MaterialState {
  using type = typename Scene::Material::template State<Scene::dimension, typename Scene::Scalar>;
};
template <class Scene>
struct MaterialState<Scene, true> {
  using type = typename Scene::Material::template AxisymmetricState<typename Scene::Scalar>;
};

/// L of a particle; with its zz in axisymmetric scenes.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto velocity_gradient_of(const ParticleArrays<T>& particles, int p) {
  const Mat<Scene::dimension, T> L = load_matrix<Scene::dimension>(particles.velocity_gradient, particles.stride, p);
  if constexpr (Scene::axisymmetric)
    return Deformation<2, T>{L, particles.hoop_rate[p]};
  else
    return L;
}

/// Calls body(constants, p, state) for every particle, then checks J.
template <class Scene, class Body>
MPM_HD void for_each_state(const Team& team, const Arguments<typename Scene::Scalar>& a, Body body) {
  using T = typename Scene::Scalar;
  using Material = typename Scene::Material;
  using State = typename MaterialState<Scene, Scene::axisymmetric>::type;
  const typename Material::template Constants<T> constants(parameters_of<Material>(a.material_parameters));
  for_each_index(team, a.particles.count, [&](int p) {
    State state = load_state<State>(a.particles.material_state, a.particles.stride, p);
    body(constants, p, state);
    const T J = Material::volume_ratio(state);
    a.particles.volume_ratio[p] = J;
    if (!(J > T(0))) Team::lower(a.first_failed, p);
  });
}

/// Kirchhoff stress and volume ratio at the current state.
template <class Scene>
MPM_HD void stress(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Material = typename Scene::Material;
  constexpr int D = Scene::dimension;
  for_each_state<Scene>(team, a, [&](const auto& constants, int p, const auto& state) {
    const Sym<D, T> tau = Material::kirchhoff_stress(constants, state);
    for (int k = 0; k < Sym<D, T>::size; ++k) a.particles.stress[k * a.particles.stride + p] = tau.s[k];
  });
}

/// Advances state and domain by dt with the gathered velocity gradient.
template <class Scene>
MPM_HD void strain(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using Material = typename Scene::Material;
  constexpr int D = Scene::dimension;
  for_each_state<Scene>(team, a, [&](const auto& constants, int p, auto& state) {
    const int stride = a.particles.stride;
    const auto L = velocity_gradient_of<Scene>(a.particles, p);
    Material::advance(constants, L, a.dt, state);
    store_state(a.particles.material_state, stride, p, state);
    if constexpr ((Scene::list && !Scene::sampled) || Scene::deformed)
      if (!a.particles.frozen)
        store_matrix(a.particles.domain, stride, p,
                     advanced(load_matrix<D>(a.particles.domain, stride, p), in_plane(L), a.dt));
  });
}

/// Speed of the fastest wave at the current state.
template <class Scene>
MPM_HD void wave_speed(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using Material = typename Scene::Material;
  for_each_state<Scene>(team, a, [&](const auto& constants, int p, const auto& state) {
    a.particles.wave_speed[p] = Material::wave_speed(constants, state);
  });
}

}  // namespace mpm::device
