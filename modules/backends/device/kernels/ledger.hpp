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
  sum_over_nodes<1>(team, a, [&](int node, double* sum) {
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
  sum_over_nodes<1>(team, a, [&](int node, double* sum) {
    const double mass = a.grid.field[N::mass][node];
    if (!(mass > 0)) return;
    for (int c = 0; c < Scene::dimension; ++c)
      sum[0] += 0.5 * twice_kinetic_energy(double(a.grid.field[N::velocity][c * a.node_count + node]), mass);
  });
}

/// Clears the works of folds that are booked.
template <class Scene>
MPM_HD void clear_work_of_folds(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  if constexpr (N::work_of_folds >= 0)
    for_each_node(team, a, [&](int node) {
      a.grid.field[N::work_of_folds][node] = a.grid.field[N::work_beyond_walls][node] = T(0);
    });
}

/// Clears the impulses of the stage before.
template <class Scene>
MPM_HD void clear_impulses(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_component<Scene::dimension>(team, a, [&](int at) {
    if constexpr (N::boundary_impulse >= 0) a.grid.field[N::boundary_impulse][at] = T(0);
    if constexpr (N::contact_impulse >= 0) a.grid.field[N::contact_impulse][at] = T(0);
    if constexpr (N::filter_impulse >= 0) a.grid.field[N::filter_impulse][at] = T(0);
    if constexpr (N::damping_impulse >= 0) a.grid.field[N::damping_impulse][at] = T(0);
  });
}

/// The impulse of one kind on a component of a node; none where the scene has no field for it.
template <int impulse, class T>
MPM_HD double impulse_at(const Arguments<T>& a, int at) {
  if constexpr (impulse >= 0) return a.grid.field[impulse][at];
  return 0;
}

/// Sums the works of the stage's impulses of boundary, contact and filter at the mean of the velocities before and
/// after them.
template <class Scene>
MPM_HD void work_of_impulses(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over_nodes<3>(team, a, [&](int node, double* sum) {
    const double mass = a.grid.field[N::mass][node];
    if (!(mass > 0)) return;
    for (int at = node; at < Scene::dimension * a.node_count; at += a.node_count) {
      const double boundary = impulse_at<N::boundary_impulse>(a, at), contact = impulse_at<N::contact_impulse>(a, at),
                   filter = impulse_at<N::filter_impulse>(a, at);
      const double mean = a.grid.field[N::velocity][at] - (boundary + contact + filter) / (2 * mass);
      sum[0] += boundary * mean;
      sum[1] += contact * mean;
      sum[2] += filter * mean;
    }
  });
}

/// Sums dt f.v of the stresses' forces, and of gravity where it has a potential.
template <class Scene>
MPM_HD void power_of_forces(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over_nodes<2>(team, a, [&](int node, double* sum) {
    if constexpr (Scene::ledger)
      for (int c = 0; c < Scene::dimension && a.grid.field[N::mass][node] > 0; ++c) {
        const int at = c * a.node_count + node;
        const double way = double(a.dt) * a.grid.field[N::velocity][at];
        sum[0] += a.grid.field[N::force][at] * way;
        if (a.gravity_has_potential[c]) sum[1] += load_at<N::weight>(a, at) * way;
      }
  });
}

/// Sums dt f.(v_filtered - v) before the forces. Neither is folded yet, so that ghosts count.
template <class Scene>
MPM_HD void power_of_filter(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over_nodes<1>(team, a, [&](int node, double* sum) {
    if constexpr (Scene::ledger && N::unfiltered_velocity >= 0)
      for (int at = node; at < Scene::dimension * a.node_count; at += a.node_count)
        sum[0] += double(a.dt) * a.grid.field[N::force][at] *
                  (double(a.grid.field[N::velocity][at]) - a.grid.field[N::unfiltered_velocity][at]);
  });
}

/// Sums what folding at walls gave the nodes, and the work of walls on what lies beyond them.
template <class Scene>
MPM_HD void work_of_folds(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over_nodes<2>(team, a, [&](int node, double* sum) {
    if constexpr (N::work_of_folds >= 0) {
      sum[0] += a.grid.field[N::work_of_folds][node];
      sum[1] += a.grid.field[N::work_beyond_walls][node];
    }
  });
}

/// Sums mass and momentum of the nodes.
template <class Scene>
MPM_HD void momentum_of_nodes(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over_nodes<4>(team, a, [&](int node, double* sum) {
    for (int c = 0; c < Scene::dimension; ++c) sum[c] += a.grid.field[N::momentum][c * a.node_count + node];
    sum[3] += a.grid.field[N::mass][node];
  });
}

/// Sums mass and momentum of the particles.
template <class Scene>
MPM_HD void momentum_of_particles(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  sum_over<4>(team, a, a.particles.count, [&](int p, double* sum) {
    const double mass = of_size<Scene>(a.particles, a.particles.mass, p);
    for (int c = 0; c < Scene::dimension; ++c)
      sum[c] += mass * a.particles.field[Scene::Particle::velocity][c * a.particles.stride + p];
    sum[3] += mass;
  });
}

/// Sums the work of the internal forces, loads and gravity, and of the impulses of conditions and contact, between v- and
/// v+ at their mean.
template <class Scene>
MPM_HD void work_of_forces(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over_nodes<11>(team, a, [&](int node, double* sum) {
    if constexpr (Scene::ledger) {
      const double mass = a.grid.field[N::mass][node], dt = a.dt;
      if (!(mass > 0)) return;
      for (int c = 0; c < Scene::dimension; ++c) {
        const int at = c * a.node_count + node;
        const double before = a.grid.field[N::velocity_before][at], after = a.grid.field[N::velocity][at];
        const double mean = mean_velocity(before, after);
        const double internal = a.grid.field[N::force][at], weight = load_at<N::weight>(a, at);
        sum[0] += dt * internal * mean;
        sum[1] += dt * load_at<N::body_force>(a, at) * mean;
        sum[6] += dt * load_at<N::surface_load>(a, at) * mean;
        sum[7] += dt * load_at<N::point_load>(a, at) * mean;
        sum[8] += dt * load_at<N::spring>(a, at) * mean;
        sum[9] += dt * load_at<N::dashpot>(a, at) * mean;
        sum[a.gravity_has_potential[c] ? 2 : 5] += dt * weight * mean;
        sum[3] += impulse_at<N::boundary_impulse>(a, at) * mean;
        sum[4] += impulse_at<N::contact_impulse>(a, at) * mean;
        sum[10] += impulse_at<N::damping_impulse>(a, at) * mean;
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
    const double mass = of_size<Scene>(a.particles, a.particles.mass, p);
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

/// Sums the energy dissipated by the last strain, the work of the stresses on it, and what it stored.
template <class Scene>
MPM_HD void energy_dissipated(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  sum_over<3>(team, a, a.particles.count, [&](int p, double* sum) {
    if constexpr (Scene::ledger) {
      const double volume = of_size<Scene>(a.particles, a.particles.volume, p);
      sum[0] += volume * a.particles.field[P::dissipated][p];
      sum[1] += volume * a.particles.field[P::stress_power][p];
      sum[2] += volume * a.particles.field[P::stored][p];
    }
  });
}

/// Sums the share of it that artificial viscosity dissipated.
template <class Scene>
MPM_HD void artificial_work(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  sum_over<1>(team, a, a.particles.count, [&](int p, double* sum) {
    if constexpr (Scene::Particle::artificial_work >= 0)
      sum[0] += double(of_size<Scene>(a.particles, a.particles.volume, p)) *
                a.particles.field[Scene::Particle::artificial_work][p];
  });
}

}  // namespace mpm::device
