#pragma once
// Takes the grid to the particles, a lane a particle: moments of a velocity field, the transfer's gather, and the move.

#include "backends/device/kernels/higher.hpp"
#include "kernel/corner_domain.hpp"
#include "operators/edges.hpp"
#include "operators/motion.hpp"

namespace mpm::device {

/// Sums the moments of `velocity` (and of velocity - before, where the transfer reads it) over a stencil.
template <class Scene>
MPM_HD GatheredMoments<Scene::dimension, typename Scene::Scalar> gathered_moments(
    const Arguments<typename Scene::Scalar>& a, const Stencil<Scene>& stencil, const typename Scene::Scalar* velocity,
    const typename Scene::Scalar* before) {
  using T = typename Scene::Scalar;
  constexpr int D = Scene::dimension;
  GatheredMoments<D, T> moments{};
  if constexpr (Scene::reads_second_moment) moments.second_moment = stencil.second_moment();
  stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
    const int node = node_index<D>(a, s.node);
    for (int i = 0; i < D; ++i) {
      const T v = velocity[i * a.node_count + node];
      moments.velocity[i] += s.weight * v;
      if constexpr (Scene::gathers_increment)
        if (before) moments.velocity_increment[i] += s.weight * (v - before[i * a.node_count + node]);
      for (int j = 0; j < D; ++j) {
        if constexpr (Scene::affine) moments.affine(i, j) += v * s.affine[j];
        moments.velocity_gradient(i, j) += v * s.gradient[j];
      }
    }
  });
  return moments;
}

/// Moves a particle's corners by the grid's multilinear velocity and by what moves it beyond the gathered velocity.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void gather_corners(const Arguments<T>& a, int p, const Vec<Scene::dimension, T>& advection,
                           const Vec<Scene::dimension, T>& gathered) {
  constexpr int D = Scene::dimension;
  using P = typename Scene::Particle;
  const int stride = a.particles.stride;
  const T* const velocity = a.grid.field[Scene::Node::velocity];
  const Vec<D, T> x = position_in_cells<Scene>(a, p);
  Vec<D, T> corners[1 << D];
  load_corners<D>(a.particles.field[P::corners], stride, p, corners);
  for (int c = 0; c < 1 << D; ++c) {
    const TentCell<D, T> cell(x, corners[c]);
    Vec<D, T> v;
    for (int i = 0; i < D; ++i) v[i] = advection[i] - gathered[i];
    for (int which = 0; which < 1 << D; ++which) {
      const T weight = cell.weight(which);
      if (weight == T(0)) continue;
      int node[D];
      for (int i = 0; i < D; ++i) node[i] = cell.node(which, i);
      const int index = node_index<D>(a, node);
      for (int i = 0; i < D; ++i) v[i] += weight * velocity[i * a.node_count + index];
    }
    for (int i = 0; i < D; ++i) corners[c][i] += a.dt * a.inverse_cell_size * v[i];
  }
  store_corners<D>(a.particles.field[P::moved_corners], stride, p, corners);
}

/// What a particle takes from the grid for what it does next.
template <class Scene>
struct Gathered {
  using T = typename Scene::Scalar;
  Mat<Scene::dimension, T> gradient;   ///< of the velocity that strains it, 1/s
  T hoop_rate;                         ///< v_r / r, 1/s, in axisymmetric scenes
  Vec<Scene::dimension, T> advection;  ///< the velocity that moves it, m/s
};

/// Gathers; without `update_particles` only what strains the particle (for USF and MUSL). False where the particle's
/// stencil does not lie inside the grid.
template <class Scene>
MPM_HD bool gather_particle(const Arguments<typename Scene::Scalar>& a, int p, Gathered<Scene>& gathered) {
  using T = typename Scene::Scalar;
  using Transfer = typename Scene::Transfer;
  using N = typename Scene::Node;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  const ParticleArrays<T>& particles = a.particles;
  const int stride = particles.stride;
  const Stencil<Scene> stencil(a, p);
  if (!stencil.inside()) return false;
  const T* before = nullptr;
  if constexpr (Scene::gathers_increment) before = a.grid.field[N::velocity_before];
  const auto moments = gathered_moments<Scene>(a, stencil, a.grid.field[N::velocity], before);
  gathered.gradient = Scene::strain_by_affine ? moments.affine : moments.velocity_gradient;
  if constexpr (Scene::axisymmetric) gathered.hoop_rate = moments.velocity[0] / particles.field[P::position][p];
  if (!a.update_particles) return true;
  Vec<D, T> v = load<D>(particles.field[P::velocity], stride, p);
  Vec<D, T>& advection = gathered.advection;
  const Vec<D, T> v_before = v;
  auto state = transfer_state<Scene>(particles, p);
  Transfer::gather(parameters_of<Transfer>(a.transfer_parameters), moments, a.dt, v, state, advection);
  if (a.filtered) v = advection = moments.velocity;
  if (a.filtered && a.moves_by_mean)
    for (int c = 0; c < D; ++c) advection[c] = mean_velocity(v_before[c], v[c]);
  if constexpr (P::grip >= 0) {
    store(particles.field[P::gathered_velocity], stride, p, v);
    if (const int grip = int(particles.field[P::grip][p]); grip > 0)
      for (int c = 0; c < D; ++c)
        if (a.grips[grip - 1].given >> c & 1) v[c] = advection[c] = particles.field[P::told_velocity][c * stride + p];
  }
  store(particles.field[P::velocity], stride, p, v);
  if constexpr (Scene::sampled) gather_corners<Scene>(a, p, advection, moments.velocity);
  store_transfer_state<Scene>(particles, p, state);
  if constexpr (Scene::basis_functions > 0) {
    Higher<Scene> higher(stencil);
    higher.gather(a, a.grid.field[N::velocity]);
    higher.store(particles, p);
  }
  return true;
}

/// Gathers and keeps what strains and moves each particle for the phases that do so.
template <class Scene>
MPM_HD void gather(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  for_each_index(team, a.particles.count, [&](int p) {
    Gathered<Scene> gathered{};
    if (!gather_particle<Scene>(a, p, gathered)) return report(a, p);
    const auto& particles = a.particles;
    store_matrix(particles.field[P::velocity_gradient], particles.stride, p, gathered.gradient);
    if constexpr (Scene::axisymmetric) particles.field[P::hoop_rate][p] = gathered.hoop_rate;
    if (a.update_particles) store(particles.field[P::advection_velocity], particles.stride, p, gathered.advection);
  });
}

/// Computes the shape's second moment at each particle, cells^2, which metrics read.
template <class Scene>
MPM_HD void second_moments(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  for_each_index(team, a.particles.count, [&](int p) {
    if constexpr (P::second_moment >= 0) {
      const Stencil<Scene> stencil(a, p);
      if (!stencil.inside()) return;  // what the host has filled in stays, which is no number
      store_matrix(a.particles.field[P::second_moment], a.particles.stride, p, stencil.second_moment());
    }
  });
}

/// Moves by x += dt advection and wraps periodic axes. Frozen particles stay. False where the particle has left the domain.
template <class Scene>
MPM_HD bool move_particle(const Arguments<typename Scene::Scalar>& a, int p,
                          const Vec<Scene::dimension, typename Scene::Scalar>& advection) {
  using T = typename Scene::Scalar;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  if (a.particles.frozen) return true;
  const int stride = a.particles.stride;
  Vec<D, T> x = load<D>(a.particles.field[P::position], stride, p);
  bool inside = true;
  Vec<D, T> way;
  for (int c = 0; c < D; ++c) way[c] = a.dt * advection[c];
  if constexpr (Scene::sampled) {  // the particle goes to the centroid of its moved corners
    Vec<D, T> corners[1 << D];
    load_corners<D>(a.particles.field[P::moved_corners], stride, p, corners);
    const CornerDomain<D, T> domain = corner_domain<D, T>(corners);
    const Vec<D, T> centre = centroid(domain, corners);
    for (int c = 0; c < D; ++c) {
      way[c] = a.cell_size * centre[c];
      for (Vec<D, T>& corner : corners) corner[c] = corner[c] - centre[c];
    }
    store_corners<D>(a.particles.field[P::corners], stride, p, corners);
    inside = domain.upright;
  }
  for (int c = 0; c < D; ++c) {
    const T size = T(a.cells[c]) * a.cell_size;
    x[c] += way[c];
    T at = x[c] - a.lower[c];
    if (a.walls[c][0] == wall_periodic) {
      x[c] -= size * floor(at / size);
      at = x[c] - a.lower[c];
    }
    const auto margin = [&](int side) {
      return a.walls[c][side] == wall_separate ? T(0.5) * a.cell_size : position_tolerance<T> * size;
    };
    inside = inside && at >= -margin(0) && at <= size + margin(1);  // this is false for NaN
  }
  if constexpr (Scene::axisymmetric) inside = inside && x[0] > T(0);
  store(a.particles.field[P::position], stride, p, x);
  if constexpr (P::strained_domain >= 0)  // no weights of this step are needed any more
    store_matrix(a.particles.field[P::domain], stride, p,
                 load_matrix<D>(a.particles.field[P::strained_domain], stride, p));
  return inside;
}

/// Moves all particles by the velocity that their gather has kept.
template <class Scene>
MPM_HD void move(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  for_each_index(team, a.particles.count, [&](int p) {
    const auto v = load<Scene::dimension>(a.particles.field[P::advection_velocity], a.particles.stride, p);
    if (!move_particle<Scene>(a, p, v)) report(a, p);
  });
}

}  // namespace mpm::device
