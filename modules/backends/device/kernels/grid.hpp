#pragma once
// The grid's work between scatter and gather: walls and periodic images by the mirror fold of simulation/boundary.hpp,
// velocities from momenta, forces. The formulas are those of operators/.

#include "backends/device/kernels/reactions.hpp"
#include "operators/motion.hpp"

namespace mpm::device {

/// Sets all fields of active nodes to zero. The marks are dropped after it.
template <class Scene>
MPM_HD void forget(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_node(team, a, [&](int node) {
    a.grid.folded[node] = 0;
    Scene::for_each_node_field([&](auto field) {
      using F = decltype(field);
      for (int c = 0; c < F::components; ++c)
        a.grid.field[F::number][c * a.node_count + node] = typename Scene::Scalar(0);
    });
  });
}

/// Sets to zero what scatters add to; for the remap of MUSL masses and momenta only.
template <class Scene>
MPM_HD void clear(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_node(team, a, [&](int node) {
    a.grid.folded[node] = 0;
    Scene::for_each_node_field([&](auto field) {
      using F = decltype(field);
      if constexpr (F::cleared) {
        if (a.remap && F::number != N::mass && F::number != N::momentum) return;
        for (int c = 0; c < F::components; ++c) a.grid.field[F::number][c * a.node_count + node] = T(0);
      }
    });
  });
}

/// Adds the weight m g of what was scattered to the field that the scene has for it: of weights, of forces, or of momenta,
/// which take it times dt.
template <class Scene>
MPM_HD void weigh(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int taken = N::weight >= 0 ? N::weight : N::force >= 0 ? N::force : N::momentum;
  const T share = taken == N::momentum ? a.dt : T(1);
  for_each_node(team, a, [&](int node) {
    for (int c = 0; c < Scene::dimension; ++c)
      a.grid.field[taken][c * a.node_count + node] += share * a.grid.field[N::mass][node] * a.gravity[c];
  });
}

/// A component of a force, zero where the scene has none of its kind.
template <int field, class T>
MPM_HD T load_at(const Arguments<T>& a, int at) {
  if constexpr (field >= 0) return a.grid.field[field][at];
  return T(0);
}

/// The sum of all forces on a node along one axis; `at` is the place of that component.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T total_force(const Arguments<T>& a, int at) {
  using N = typename Scene::Node;
  T force = load_at<N::force>(a, at) + load_at<N::weight>(a, at);
  force += load_at<N::body_force>(a, at);
  force += load_at<N::surface_load>(a, at);
  force += load_at<N::point_load>(a, at);
  force += load_at<N::spring>(a, at);
  force += load_at<N::dashpot>(a, at);
  return force;
}

// ---- folds -------------------------------------------------------------------------------------------------------

/// Adds a ghost's values of one field to its mirror's by the field's rule, and clears them unless they stay. `mass` and
/// `heat_capacity` are the ghost's.
template <class F, bool stays = false, class T>
MPM_HD void fold_field(const Arguments<T>& a, const Fold& fold, T mass, T heat_capacity = T(0)) {
  constexpr bool of_heat = F::at_wall == rule_heat || F::at_wall == rule_heat_rate;
  for (int c = 0; c < F::components; ++c) {
    T* const values = a.grid.field[F::number] + c * a.node_count;
    T of_wall = T(0);
    if constexpr (F::at_wall == rule_momentum) of_wall = mass * velocity_of_wall(a, fold, c);
    if constexpr (F::at_wall == rule_heat) of_wall = heat_capacity * temperature_of_wall(a, fold);
    const bool held = of_heat && holds_temperature(a, fold);
    const T sign = T(mirror_sign(F::at_wall, fold.wall, held, fold.axis, c));
    values[fold.mirror] += mirrored(values[fold.ghost], sign, of_wall);
    if (!stays) values[fold.ghost] = T(0);
  }
}

/// Notes what the image of a ghost's momentum gains of energy, and what is lost as its mass joins the mirror's: that of
/// their relative velocity, with the reduced mass.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void note_work_of_fold(const Arguments<T>& a, const Fold& fold) {
  using N = typename Scene::Node;
  if constexpr (N::work_of_folds >= 0) {
    if (!a.records || fold.wall == wall_periodic) return;
    const double own = a.grid.field[N::mass][fold.ghost], mirror = a.grid.field[N::mass][fold.mirror];
    double gained = 0, apart = 0;
    for (int c = 0; c < Scene::dimension; ++c) {
      const T* const momentum = a.grid.field[N::momentum] + c * a.node_count;
      const T sign = T(mirror_sign(fold.wall, fold.axis, c)), wall = T(own) * velocity_of_wall(a, fold, c);
      const double before = momentum[fold.ghost], image = mirrored(momentum[fold.ghost], sign, wall);
      gained += 0.5 * (image - before) * (image + before) / own;
      if (!(mirror > 0)) continue;
      const double difference = image / own - momentum[fold.mirror] / mirror;
      apart += difference * difference;
    }
    a.grid.field[N::work_of_folds][fold.ghost] += T(gained - 0.5 * own * mirror / (own + mirror) * apart);
  }
}

/// Adds what is folded with the masses along a.axis to the mirrors, and marks the ghosts. A separating wall folds while
/// the pair approaches it, by p + dt f.
template <class Scene>
MPM_HD void fold_masses(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  const auto fold_node = [&](const Fold& fold, T gradient, double* sums) {
    T* const masses = a.grid.field[N::mass];
    const T mass = masses[fold.ghost];
    if (!(mass > T(0))) return;
    if (fold.wall == wall_separate) {
      const auto speed = [&](int node) {
        const int at = fold.axis * a.node_count + node;
        return masses[node] > T(0) ? predicted_velocity(a.grid.field[N::momentum][at], total_force<Scene>(a, at),
                                                        masses[node], a.remap ? T(0) : a.dt)
                                   : T(0);
      };
      if (!approaches(fold.side, speed(fold.ghost) + speed(fold.mirror))) return;
    }
    if (fold.ghost != fold.mirror) {
      a.grid.folded[fold.ghost] |= 1 << fold.axis;
      note_active(a.grid, fold.mirror);
      note_work_of_fold<Scene>(a, fold);
      note_image<Scene>(
          a, fold, mass, [&](int c) { return a.grid.field[N::momentum][c * a.node_count + fold.ghost]; }, sums);
    }
    if constexpr (N::folded_mass >= 0) a.grid.field[N::folded_mass][fold.ghost] = mass;
    T heat_capacity = T(0), heat = T(0);
    if constexpr (N::heat_capacity >= 0) {
      heat_capacity = a.grid.field[N::heat_capacity][fold.ghost];
      if (!a.remap) heat = heat_of_image<Scene>(a, fold, heat_capacity, gradient);
      if constexpr (N::folded_capacity >= 0)
        if (!a.remap) a.grid.field[N::folded_capacity][fold.ghost] = heat_capacity;
    }
    Scene::for_each_node_field([&](auto field) {
      using F = decltype(field);
      if constexpr (F::folded == folded_with_mass) {
        if (a.remap && F::number != N::mass && F::number != N::momentum) return;
        // Folds along other axes look at what lies on this wall beyond theirs.
        constexpr bool stays = F::number == N::heated_volume || F::number == N::volume_conductivity;
        if (fold.ghost != fold.mirror)
          fold_field<F, stays>(a, fold, mass, heat_capacity);
        else if (F::at_wall == rule_slip)  // the image takes away what points across the wall
          a.grid.field[F::number][fold.axis * a.node_count + fold.ghost] = T(0);
      }
    });
    if constexpr (N::heat >= 0) a.grid.field[N::heat][fold.mirror] += heat;
  };
  for_each_line<Scene>(team, a, [&](int line, double* sums) {
    T gradients[2] = {T(0), T(0)};
    for (int side = 0; side < 2 && !a.remap; ++side)
      gradients[side] = gradient_at_wall<Scene>(a, foot_of_line(a, line, side), false);
    for_each_fold_of_line(a, line, true, !a.remap,
                          [&](const Fold& fold) { fold_node(fold, gradients[fold.side], sums); });
  });
}

/// Notes the work of a moving wall on what lies beyond it: a ghost moves at (1 - sign) times the wall's velocity beside
/// its mirror's, and particles are strained and lifted by that too.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void note_work_beyond_wall(const Arguments<T>& a, const Fold& fold) {
  using N = typename Scene::Node;
  if constexpr (N::work_beyond_walls >= 0) {
    if (!a.records) return;
    for (int c = 0; c < Scene::dimension; ++c) {
      const int at = c * a.node_count + fold.ghost;
      T force = load_at<N::force>(a, at);
      if (a.gravity_has_potential[c]) force += load_at<N::weight>(a, at);
      const T sign = T(mirror_sign(fold.wall, fold.axis, c));
      a.grid.field[N::work_beyond_walls][fold.ghost] -= a.dt * force * (T(1) - sign) * velocity_of_wall(a, fold, c);
    }
  }
}

/// Does the same for forces, along the folds that were made.
template <class Scene>
MPM_HD void fold_forces(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_line<Scene>(team, a, [&](int line, double* sums) {
    for_each_fold_of_line(a, line, true, false, [&](const Fold& fold) {
      if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
      note_work_beyond_wall<Scene>(a, fold);
      note_image<Scene>(
          a, fold, T(0), [&](int c) { return total_force<Scene>(a, c * a.node_count + fold.ghost); }, sums);
      Scene::for_each_node_field([&](auto field) {
        using F = decltype(field);
        if constexpr (F::folded == folded_with_force) fold_field<F>(a, fold, T(0));
      });
    });
  });
}

/// Gives ghosts the mirrored velocities, and the mirrored change of them.
template <class Scene>
MPM_HD void fill_velocities(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_fold(team, a, false, false, [&](const Fold& fold) {
    if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
    for (int c = 0; c < Scene::dimension; ++c) {
      const T sign = T(mirror_sign(fold.wall, fold.axis, c));
      T* const velocity = a.grid.field[N::velocity] + c * a.node_count;
      velocity[fold.ghost] = mirrored(velocity[fold.mirror], sign, velocity_of_wall(a, fold, c));
      if constexpr (N::velocity_before >= 0) {
        T* const before = a.grid.field[N::velocity_before] + c * a.node_count;
        before[fold.ghost] = velocity[fold.ghost] - sign * (velocity[fold.mirror] - before[fold.mirror]);
      }
    }
  });
}

// ---- nodes -------------------------------------------------------------------------------------------------------

/// Computes v = p / m. A node without mass is at rest.
template <class Scene>
MPM_HD void divide(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_component<Scene::dimension>(team, a, [&](int at) {
    const T mass = a.grid.field[N::mass][at % a.node_count];
    a.grid.field[N::velocity][at] = mass > T(0) ? velocity_of(a.grid.field[N::momentum][at], mass) : T(0);
  });
}

/// Keeps v- <- v.
template <class Scene>
MPM_HD void keep_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  if constexpr (N::velocity_before >= 0)
    for_each_component<Scene::dimension>(
        team, a, [&](int at) { a.grid.field[N::velocity_before][at] = a.grid.field[N::velocity][at]; });
}

/// Applies v += dt f / m.
template <class Scene>
MPM_HD void accelerate(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_node(team, a, [&](int node) {
    const T mass = a.grid.field[N::mass][node];
    for (int at = node; at < Scene::dimension * a.node_count; at += a.node_count) {
      T& velocity = a.grid.field[N::velocity][at];
      velocity = mass > T(0) ? accelerated(velocity, total_force<Scene>(a, at), mass, T(0), a.dt) : T(0);
    }
  });
}

/// Damps what the forces, conditions and contact have made of v-.
template <class Scene>
MPM_HD void damp(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  if constexpr (N::velocity_before >= 0)
    for_each_component<Scene::dimension>(team, a, [&](int at) {
      const T mass = a.grid.field[N::mass][at % a.node_count];
      if (!(mass > T(0))) return;
      T& velocity = a.grid.field[N::velocity][at];
      const T now = damped<T>(a.grid.field[N::velocity_before][at], velocity, a.local_damping, a.left_of_velocity,
                              a.left_of_change);
      if constexpr (N::damping_impulse >= 0)
        if (a.records) a.grid.field[N::damping_impulse][at] += mass * (now - velocity);
      velocity = now;
    });
}

}  // namespace mpm::device
