#pragma once
// Lets nodes know of particles that a grip moves.

#include "backends/device/kernels/formulas.hpp"
#include "backends/device/kernels/scatter.hpp"
#include "backends/device/kernels/sums.hpp"
#include "operators/supports.hpp"

namespace mpm::device {

/// Finds the velocity that each gripped particle is told to have at the end of the step.
template <class Scene>
MPM_HD void tell_gripped(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.particles.count, [&]([[maybe_unused]] int p) {
    if constexpr (P::grip >= 0) {
      const int grip = int(a.particles.field[P::grip][p]) - 1;
      if (grip < 0) return;
      const FormulaPlace<Scene> place(a.particles, p);
      const Vec<D, T> told = Scene::velocity_of_grip(grip, place.x, place.X, a.formula_numbers);
      store(a.particles.field[P::told_velocity], a.particles.stride, p, told);
      for (int c = 0; c < D; ++c)
        if (a.grips[grip].given >> c & 1 && !is_number(double(told[c]))) return report(a, p);
    }
  });
}

template <class Scene>
inline constexpr int scatter_grip_scalars = (2 * Scene::dimension + 1) * Tile<Scene::dimension>::nodes;

/// Scatters the mass of the particles of a.grip, the momentum that they are told to have at the end of the step, and the
/// one that they have.
template <class Scene>
MPM_HD void scatter_grip(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  if constexpr (P::grip >= 0) {
    const GripArrays<T>& grip = a.grips[a.grip];
    T* channel[2 * D + 1];
    for (int c = 0; c < D; ++c)
      channel[c] = grip.momentum + c * a.node_count, channel[D + c] = grip.before + c * a.node_count;
    channel[2 * D] = grip.mass;
    scatter_blocks<Scene, 2 * D + 1>(team, a, channel, [&](int p, auto add) {
      if (int(a.particles.field[P::grip][p]) != a.grip + 1) return;
      const Stencil<Scene> stencil(a, p);
      if (!stencil.inside()) return report(a, p);
      const T mass_of_particle = of_size<Scene>(a.particles, a.particles.mass, p);
      const int stride = a.particles.stride;
      stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
        T values[2 * D + 1];
        const T mass = s.weight * mass_of_particle;
        for (int c = 0; c < D; ++c) {
          values[c] = mass * a.particles.field[P::told_velocity][c * stride + p];
          values[D + c] = mass * a.particles.field[P::velocity][c * stride + p];
        }
        values[2 * D] = mass;
        add(s.node, values);
      });
    });
  }
}

/// Sums what the grip a.grip has given its particles after the gather: impulse, its moment, and energy.
template <class Scene>
MPM_HD void given_to_gripped(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  sum_over<7>(team, a, a.particles.count, [&]([[maybe_unused]] int p, [[maybe_unused]] double* sums) {
    if constexpr (P::grip >= 0) {
      if (int(a.particles.field[P::grip][p]) != a.grip + 1) return;
      const int stride = a.particles.stride;
      double x[3] = {}, from[3] = {}, to[3] = {};
      for (int c = 0; c < D; ++c) {
        x[c] = a.particles.field[P::position][c * stride + p];
        from[c] = a.particles.field[P::gathered_velocity][c * stride + p];
        to[c] = a.particles.field[P::velocity][c * stride + p];
      }
      add_given_to_particle(sums, sums + 3, sums[6], of_size<Scene>(a.particles, a.particles.mass, p), x, from, to);
    }
  });
}

}  // namespace mpm::device
