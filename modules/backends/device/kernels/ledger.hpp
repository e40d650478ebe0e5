#pragma once
// These kernels measure what the energy ledger asks of nodes and particles.

#include "backends/device/kernels/grid.hpp"
#include "backends/device/kernels/scatter.hpp"
#include "backends/device/kernels/sums.hpp"
#include "operators/motion.hpp"

namespace mpm::device {

/// Sums p.p / 2m.
template <class Scene>
MPM_HD void energy_of_momenta(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over<1>(team, a, a.node_count, [&](int node, double* sum) {
    const double mass = a.grid.field[N::mass][node];
    if (!(mass > 0)) return;
    for (int c = 0; c < Scene::dimension; ++c) {
      const double p = a.grid.field[N::momentum][c * a.node_count + node];
      sum[0] += 0.5 * p * p / mass;
    }
  });
}

/// Sums m v.v / 2.
template <class Scene>
MPM_HD void energy_of_velocities(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over<1>(team, a, a.node_count, [&](int node, double* sum) {
    const double mass = a.grid.field[N::mass][node];
    if (!(mass > 0)) return;
    for (int c = 0; c < Scene::dimension; ++c)
      sum[0] += 0.5 * twice_kinetic_energy(double(a.grid.field[N::velocity][c * a.node_count + node]), mass);
  });
}

/// Sums the work of the internal, body and gravity forces between v- and v+ at their mean, and of what they do not
/// explain: the reactions of conditions on held components and of contact on the others.
template <class Scene>
MPM_HD void work_of_forces(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over<6>(team, a, a.node_count, [&](int node, double* sum) {
    if constexpr (Scene::ledger) {
      const double mass = a.grid.field[N::mass][node], dt = a.dt;
      if (!(mass > 0)) return;
      for (int c = 0; c < Scene::dimension; ++c) {
        const int at = c * a.node_count + node;
        const double before = a.grid.field[N::velocity_before][at], after = a.grid.field[N::velocity][at];
        const double mean = mean_velocity(before, after);
        double body = 0;
        if constexpr (N::body_force >= 0) body = a.grid.field[N::body_force][at];
        const double internal = a.grid.field[N::force][at], weight = a.grid.field[N::weight][at];
        sum[0] += dt * internal * mean;
        sum[1] += dt * body * mean;
        sum[a.walls[c][0] == wall_periodic ? 5 : 2] += dt * weight * mean;
        sum[a.grid.held[node] >> c & 1 ? 3 : 4] +=
            work_of_reaction(before, after, mass, internal + body + weight, mean, dt);
      }
    }
  });
}

/// Sums the particles' kinetic energy with the affine part m/2 tr(C D C^T) and that of the polynomials beyond it.
template <class Scene>
MPM_HD void energy_of_particles(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  sum_over<1>(team, a, a.particles.count, [&](int p, double* sum) {
    const int stride = a.particles.stride;
    const double mass = of_ring<Scene>(a.particles, a.particles.mass, p);
    double squares = 0;
    for (int c = 0; c < D; ++c) {
      const double v = a.particles.field[P::velocity][c * stride + p];
      squares += v * v;
    }
    if constexpr (Scene::affine_carries_energy || Scene::basis_functions > 0) {
      const Stencil<Scene> stencil(a, p);
      if (!stencil.inside()) return;  // the gather has reported it
      if constexpr (Scene::affine_carries_energy) {
        const Mat<D, T> C = load_matrix<D>(a.particles.field[P::transfer_state], stride, p);
        const Mat<D, T> moment = stencil.second_moment();
        for (int i = 0; i < D; ++i)
          for (int j = 0; j < D; ++j)
            for (int k = 0; k < D; ++k) squares += double(a.cell_size) * a.cell_size * C(i, j) * moment(j, k) * C(i, k);
      }
      if constexpr (Scene::basis_functions > 0) squares += higher_of<Scene>(a, stencil, p).squares();
    }
    sum[0] += 0.5 * mass * squares;
  });
}

/// Sums the energy dissipated by the last strain.
template <class Scene>
MPM_HD void energy_dissipated(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  sum_over<1>(team, a, a.particles.count, [&](int p, double* sum) {
    if constexpr (Scene::ledger)
      sum[0] += double(of_ring<Scene>(a.particles, a.particles.volume, p)) *
                a.particles.field[Scene::Particle::dissipated][p];
  });
}

}  // namespace mpm::device
