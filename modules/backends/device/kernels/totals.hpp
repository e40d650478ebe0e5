#pragma once
// Sums and extremes of a body's particles for metrics, in double precision whatever the scene's: energies are small differences
// of the numbers in a state.

#include "backends/device/kernels/ledger.hpp"
#include "backends/device/kernels/material.hpp"
#include "backends/device/kernels/totals_list.hpp"

namespace mpm::device {

template <class Scene>
MPM_HD void add_particles(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  join_teams<AddingParticles>(team, a);
}

/// The mass or volume of a particle in double precision, given that of one of size 1.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD double in_double(const ParticleArrays<T>& particles, T of_body, int p) {
  if constexpr (Scene::Particle::size >= 0) return double(of_body) * double(particles.field[Scene::Particle::size][p]);
  return of_body;
}

MPM_HD void cross(const double* a, const double* b, double* product) {
  for (int c = 0; c < 3; ++c) product[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

/// Adds the affine part C of a velocity over the nodes of a particle: m sum w |C d|^2 / 2 and m sum w d x (C d).
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void add_affine(const Arguments<T>& a, const Stencil<Scene>& stencil, int p, double m, double* sums) {
  constexpr int D = Scene::dimension;
  const Mat<D, T> C = load_matrix<D>(a.particles.field[Scene::Particle::transfer_state], a.particles.stride, p);
  const Mat<D, T> moment = stencil.second_moment();
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      const double share = m * double(a.cell_size) * double(a.cell_size) * double(moment(i, j));
      double d[3] = {}, column[3] = {}, spin[3];
      d[i] = 1;
      for (int c = 0; c < D; ++c) column[c] = C(c, j);
      cross(d, column, spin);
      for (int c = 0; c < D; ++c) sums[motion_kinetic] += 0.5 * share * double(C(c, i)) * column[c];
      for (int c = 0; c < 3; ++c) sums[motion_angular_momentum + c] += share * spin[c];
    }
}

/// Sums mass, energy and momenta. Of a particle whose second moment nobody knows they are not a number.
template <class Scene>
MPM_HD void totals_of_motion(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  sum_over<motion_sums, 1, AddingParticles>(team, a, a.particles.count, [&](int p, double* sums) {
    const double m = in_double<Scene>(a.particles, a.particles.mass, p);
    double x[3] = {}, v[3] = {}, spin[3];
    for (int c = 0; c < D; ++c) {
      x[c] = a.particles.field[P::position][c * a.particles.stride + p];
      v[c] = a.particles.field[P::velocity][c * a.particles.stride + p];
    }
    cross(x, v, spin);
    const double squares = v[0] * v[0] + v[1] * v[1] + v[2] * v[2], speed = sqrt(squares);
    sums[motion_particles] = 1, sums[motion_mass] = m, sums[motion_kinetic] = 0.5 * m * squares;
    for (int c = 0; c < 3; ++c) {
      sums[motion_momentum + c] = m * v[c], sums[motion_angular_momentum + c] = m * spin[c];
      sums[motion_place + c] = m * x[c];
    }
    sums[motion_momentum_scale] = m * speed, sums[motion_largest_speed] = speed;
    sums[motion_angular_momentum_scale] = m * speed * sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    if constexpr (Scene::affine_carries_energy || Scene::basis_functions > 0) {
      const Stencil<Scene> stencil(a, p);
      if (!stencil.inside()) sums[motion_kinetic] = sums[motion_angular_momentum] = sqrt(-1.0);
      if (!stencil.inside()) return;
      if constexpr (Scene::affine_carries_energy) add_affine<Scene>(a, stencil, p, m, sums);
      if constexpr (Scene::basis_functions > 0)
        sums[motion_kinetic] += 0.5 * m * double(higher_of<Scene>(a, stencil, p).squares());
    }
  });
}

/// The scene with functors in double precision.
template <class Scene>
struct InDouble : Scene {
  using Scalar = double;
};

/// The part of a particle that its material keeps, in double precision.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto material_state_in_double(const ParticleArrays<T>& particles, int p) {
  using P = typename Scene::Particle;
  using State = typename MaterialState<InDouble<Scene>, Scene::axisymmetric>::type;
  State state{};
  double* const flat = reinterpret_cast<double*>(&state);
  for (int k = 0; k < kept_scalars<InDouble<Scene>, State>; ++k)
    flat[k] = particles.field[P::material_state][k * particles.stride + p];
  if constexpr (Scene::reads_temperature) {
    if constexpr (P::temperature >= 0)
      state.temperature = particles.field[P::temperature][p];
    else
      state.temperature = Scene::reference_temperature;
  }
  return state;
}

/// Sums the energy that the material stores, and finds the extremes of the volume ratio.
template <class Scene>
MPM_HD void totals_of_state(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using Material = typename Scene::Material;
  using Constants = typename Material::template Constants<double>;
  const Constants solid(parameters_of<Material>(a.material_parameters));
  [[maybe_unused]] const Constants melted(parameters_of<Material>(a.melted_parameters));
  sum_over<state_sums, 2, AddingParticles>(team, a, a.particles.count, [&](int p, double* sums) {
    const auto state = material_state_in_double<Scene>(a.particles, p);
    const double J = Material::volume_ratio(state);
    const Constants& constants = has_melted<Scene>(a.particles, p) ? melted : solid;
    sums[state_particles] = 1;
    sums[state_strain_energy] =
        in_double<Scene>(a.particles, a.particles.volume, p) * Material::stored_energy(constants, state);
    sums[state_smallest_volume_ratio] = -J, sums[state_largest_volume_ratio] = J;
  });
}

/// Sums heat from the melting temperature and latent heat, and finds the extremes of the temperature.
template <class Scene>
MPM_HD void totals_of_heat(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  sum_over<heat_sums, 2, AddingParticles>(team, a, a.particles.count, [&](int p, double* sums) {
    const double m = in_double<Scene>(a.particles, a.particles.mass, p), now = a.particles.field[P::temperature][p];
    sums[heat_particles] = 1;
    sums[heat_content] =
        m * double(heat_capacity_of<Scene>(a.particles, p)) * (now - double(a.particles.heat.melting_temperature));
    if constexpr (P::melted_fraction >= 0)
      sums[heat_latent] = m * double(a.particles.heat.latent_heat) * double(a.particles.field[P::melted_fraction][p]);
    sums[heat_lowest] = -now, sums[heat_highest] = now;
  });
}

}  // namespace mpm::device
