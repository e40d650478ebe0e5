#pragma once
// The material functor works on its particles, a lane a particle: stress, strain, wave speed. A particle whose volume
// ratio is not a positive number is reported as failed.

#include "backends/device/kernels/arrays.hpp"
#include "backends/device/kernels/sums.hpp"
#include "operators/dilation.hpp"
#include "operators/heat.hpp"

namespace mpm::device {

/// The part of a particle that its material keeps.
template <class Scene, bool Axisymmetric>
struct MaterialState {
  using type = typename Scene::Material::template State<Scene::dimension, typename Scene::Scalar>;
};
template <class Scene>
struct MaterialState<Scene, true> {
  using type = typename Scene::Material::template AxisymmetricState<typename Scene::Scalar>;
};

/// How many scalars of the State particles keep: the temperature, which is its last where a material reads it, is the
/// host's.
template <class Scene, class State>
inline constexpr int kept_scalars = scalars_of<State, typename Scene::Scalar> - (Scene::reads_temperature ? 1 : 0);

template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto load_material_state(const ParticleArrays<T>& particles, int p) {
  using P = typename Scene::Particle;
  using State = typename MaterialState<Scene, Scene::axisymmetric>::type;
  State state =
      load_state<State, T, kept_scalars<Scene, State>>(particles.field[P::material_state], particles.stride, p);
  if constexpr (Scene::reads_temperature) {
    if constexpr (P::temperature >= 0)
      state.temperature = particles.field[P::temperature][p];
    else
      state.temperature = T(Scene::reference_temperature);
  }
  return state;
}
template <class Scene, class State, class T = typename Scene::Scalar>
MPM_HD void store_material_state(const ParticleArrays<T>& particles, int p, const State& state) {
  store_state<State, T, kept_scalars<Scene, State>>(particles.field[Scene::Particle::material_state], particles.stride,
                                                    p, state);
}

/// The velocity gradient L, with its zz in axisymmetric scenes.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto with_hoop_rate(const Mat<Scene::dimension, T>& L, [[maybe_unused]] const T& hoop_rate) {
  if constexpr (Scene::axisymmetric)
    return Deformation<2, T>{L, hoop_rate};
  else
    return L;
}

/// That of a particle, as its gather has kept it.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto velocity_gradient_of(const ParticleArrays<T>& particles, int p) {
  using P = typename Scene::Particle;
  T hoop_rate = T(0);
  if constexpr (Scene::axisymmetric) hoop_rate = particles.field[P::hoop_rate][p];
  return with_hoop_rate<Scene>(
      load_matrix<Scene::dimension>(particles.field[P::velocity_gradient], particles.stride, p), hoop_rate);
}

/// Whether a particle has the parameters of its material's melted phase.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD bool has_melted(const ParticleArrays<T>& particles, int p) {
  if constexpr (Scene::Particle::melted_fraction >= 0)
    return is_melted(particles.field[Scene::Particle::melted_fraction][p]);
  else
    return false;
}

/// The heat capacity c of a particle, J/(kg K).
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T heat_capacity_of(const ParticleArrays<T>& particles, int p) {
  return particles.heat.heat_capacity[has_melted<Scene>(particles, p) ? 1 : 0];
}

/// Keeps the volume ratio J of a particle; false where it is not a positive number.
template <class Scene, class State, class T = typename Scene::Scalar>
MPM_HD bool keep_volume_ratio(const Arguments<T>& a, int p, const State& state) {
  const T J = Scene::Material::volume_ratio(state);
  a.particles.field[Scene::Particle::volume_ratio][p] = J;
  return J > T(0);
}

/// Calls body(constants, p, state) for every particle, then checks J.
template <class Scene, class Body>
MPM_HD void for_each_state(const Team& team, const Arguments<typename Scene::Scalar>& a, Body body) {
  using T = typename Scene::Scalar;
  using Material = typename Scene::Material;
  using Constants = typename Material::template Constants<T>;
  const auto visit = [&](const Constants& constants, int p) {
    auto state = load_material_state<Scene>(a.particles, p);
    body(constants, p, state);
    if (!keep_volume_ratio<Scene>(a, p, state)) report(a, p);
  };
  const Constants constants(parameters_of<Material>(a.material_parameters));
  if constexpr (Scene::Particle::melted_fraction >= 0) {
    const Constants melted(parameters_of<Material>(a.melted_parameters));
    for_each_index(team, a.particles.count,
                   [&](int p) { visit(has_melted<Scene>(a.particles, p) ? melted : constants, p); });
  } else {
    for_each_index(team, a.particles.count, [&](int p) { visit(constants, p); });
  }
}

/// The Kirchhoff stress of a particle, with that of artificial viscosity.
template <class Scene, class Constants, class State, class T = typename Scene::Scalar>
MPM_HD Sym<Scene::dimension, T> kirchhoff_stress_of(const ParticleArrays<T>& particles, int p,
                                                    const Constants& constants, const State& state) {
  Sym<Scene::dimension, T> tau = Scene::Material::kirchhoff_stress(constants, state);
  if constexpr (Scene::Particle::artificial_pressure >= 0)
    for (int k = 0; k < 3; ++k) tau.s[k] -= particles.field[Scene::Particle::artificial_pressure][p];
  return tau;
}

/// Finds J q of a strain by L that the material has just made; returns the work of q on it, J/m^3, by the trapezoidal rule:
/// the forces before the strain had the old pressure, and those after it have the new one.
template <class Scene, class Constants, class State, class Gradient, class T = typename Scene::Scalar>
MPM_HD T strain_artificially(const Arguments<T>& a, int p, const Constants& constants, const State& state,
                             const Gradient& L) {
  T& pressure = a.particles.field[Scene::Particle::artificial_pressure][p];
  const T change = log_of_change(volume_change(L, a.dt)), before = pressure;
  pressure =
      a.particles.viscosity.pressure(compression_rate(change, a.dt), T(Scene::Material::wave_speed(constants, state)));
  const T work = T(-0.5) * change * (before + pressure);
  if constexpr (Scene::Particle::artificial_work >= 0) a.particles.field[Scene::Particle::artificial_work][p] = work;
  return work;
}

/// Keeps the Kirchhoff stress of a particle.
template <class Scene, class Constants, class State, class T = typename Scene::Scalar>
MPM_HD void keep_stress(const Arguments<T>& a, int p, const Constants& constants, const State& state) {
  const Sym<Scene::dimension, T> tau = kirchhoff_stress_of<Scene>(a.particles, p, constants, state);
  for (int k = 0; k < Sym<Scene::dimension, T>::size; ++k)
    a.particles.field[Scene::Particle::stress][k * a.particles.stride + p] = tau.s[k];
}

/// Evaluates Kirchhoff stress and volume ratio at the current state.
template <class Scene>
MPM_HD void stress(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_state<Scene>(
      team, a, [&](const auto& constants, int p, const auto& state) { keep_stress<Scene>(a, p, constants, state); });
}

/// Notes half of the work of the stress as it is on a strain, and the stored energy: before the strain with the other
/// sign, `after` it of what dt L is of the strained body, dt L (I + dt L)^-1 to second order.
template <class Scene, class Constants, class State, class Gradient, class T = typename Scene::Scalar>
MPM_HD void note_stress(const Arguments<T>& a, int p, const Constants& constants, const State& state, const Gradient& L,
                        bool after) {
  using Material = typename Scene::Material;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  const Sym<D, T> tau = kirchhoff_stress_of<Scene>(a.particles, p, constants, state);
  const Mat<D, T> plane = in_plane(L);
  const T share = after ? a.dt : T(0);
  T power = T(0);
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      T squared = T(0);
      for (int k = 0; k < D; ++k) squared += plane(i, k) * plane(k, j);
      power += tau.s[Sym<D, T>::index(i, j)] * (plane(i, j) - share * squared);
    }
  if constexpr (Scene::axisymmetric) {
    const T hoop = L.zz;
    power += tau.s[2] * (hoop - share * hoop * hoop);
  }
  const T energy = Material::stored_energy(constants, state), half = a.dt / 2 * power;
  T &work = a.particles.field[P::stress_power][p], &stored = a.particles.field[P::stored][p];
  work = after ? work + half : half;
  stored = after ? stored + energy : -energy;
}

/// Advances state and domain of a particle by dt with the velocity gradient L; what is dissipated warms the particle.
template <class Scene, class Constants, class State, class Gradient, class T = typename Scene::Scalar>
MPM_HD void strain_particle(const Arguments<T>& a, int p, const Constants& constants, State& state, const Gradient& L) {
  using Material = typename Scene::Material;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  const int stride = a.particles.stride;
  if constexpr (P::stress_power >= 0)
    if (a.records) note_stress<Scene>(a, p, constants, state, L, false);
  [[maybe_unused]] auto dissipated = Material::advance(constants, L, a.dt, state);
  if constexpr (P::artificial_pressure >= 0) dissipated += strain_artificially<Scene>(a, p, constants, state, L);
  if constexpr (P::dissipated >= 0) a.particles.field[P::dissipated][p] = dissipated;
  if constexpr (P::stress_power >= 0)
    if (a.records) note_stress<Scene>(a, p, constants, state, L, true);
  if constexpr (P::temperature >= 0)
    a.particles.field[P::temperature][p] +=
        a.particles.heat.warming * dissipated / heat_capacity_of<Scene>(a.particles, p);
  store_material_state<Scene>(a.particles, p, state);
  if (a.particles.frozen) return;
  if constexpr (P::deformation >= 0) {
    auto* const deformation = a.particles.field[P::deformation];
    store_matrix(deformation, stride, p, advanced(load_matrix<D>(deformation, stride, p), in_plane(L), a.dt));
  }
  if constexpr (P::domain >= 0) {
    auto* const domain = a.particles.field[P::strained_domain >= 0 ? P::strained_domain : P::domain];
    store_matrix(domain, stride, p, advanced(load_matrix<D>(domain, stride, p), in_plane(L), a.dt));
  }
}

/// Strains all particles by the velocity gradient that their gather has kept.
template <class Scene>
MPM_HD void strain(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  for_each_state<Scene>(team, a, [&](const auto& constants, int p, auto& state) {
    auto L = velocity_gradient_of<Scene>(a.particles, p);
    if constexpr (P::mean_dilation >= 0) take_mean_dilation(L, a.particles.field[P::mean_dilation][p], a.dt);
    strain_particle<Scene>(a, p, constants, state, L);
  });
}

/// Finds the speed of the fastest wave at the current state, or what artificial viscosity makes of it for the step.
template <class Scene>
MPM_HD void wave_speed(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using Material = typename Scene::Material;
  using P = typename Scene::Particle;
  for_each_state<Scene>(team, a, [&](const auto& constants, int p, const auto& state) {
    auto& speed = a.particles.field[P::wave_speed][p];
    speed = Material::wave_speed(constants, state);
    if constexpr (P::artificial_pressure >= 0)
      if (a.particles.viscosity.density > 0)
        speed = a.particles.viscosity.damped_speed(speed * speed, a.particles.field[P::artificial_pressure][p],
                                                   a.inverse_cell_size);
  });
}

/// Finds the largest sum of a particle's wave speed and speed, that wave speed, and the particle's index; of equal ones
/// the first.
template <class Scene>
MPM_HD void largest_speed(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  sum_over<3, 0, TakingLargest>(team, a, a.particles.count, [&](int p, double* values) {
    double square = 0;
    for (int c = 0; c < Scene::dimension; ++c) {
      const double v = a.particles.field[P::velocity][c * a.particles.stride + p];
      square += v * v;
    }
    const double wave = a.particles.field[P::wave_speed][p];
    const double speed = wave + sqrt(square);
    if (speed > 0) values[0] = speed, values[1] = wave, values[2] = p;  // not what is no number
  });
}

}  // namespace mpm::device
