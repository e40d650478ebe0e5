#pragma once
// The grid between scatter and gather: walls and periodic images by the mirror fold of simulation/boundary.hpp, momenta
// to velocities, forces, conditions. A fold runs along the lines of one axis, a lane a line: nothing is written by two
// lanes. The formulas are those of operators/.

#include "backends/device/kernels/arrays.hpp"
#include "operators/edges.hpp"
#include "operators/motion.hpp"

namespace mpm::device {

/// What scatters add to, to zero; for the remap of MUSL masses and momenta only.
template <class Scene>
MPM_HD void clear(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_index(team, a.node_count, [&](int node) {
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

/// The weight of what was scattered: m g.
template <class Scene>
MPM_HD void weigh(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  for_each_index(team, a.node_count, [&](int node) {
    for (int c = 0; c < Scene::dimension; ++c)
      a.grid.field[N::weight][c * a.node_count + node] += a.grid.field[N::mass][node] * a.gravity[c];
  });
}

/// All forces on a node, along one axis; `at` is the place of that component.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T total_force(const Arguments<T>& a, int at) {
  using N = typename Scene::Node;
  T force = a.grid.field[N::force][at] + a.grid.field[N::weight][at];
  if constexpr (N::body_force >= 0) force += a.grid.field[N::body_force][at];
  return force;
}

// ---- folds -------------------------------------------------------------------------------------------------------

/// A ghost beyond the wall (or image) at one end of a line, and the node that it is folded onto.
struct Fold {
  int ghost, mirror, axis, side;
  int wall, line;
};

/// Velocity of the wall at the foot of a fold's ghost.
template <class T>
MPM_HD T velocity_of_wall(const Arguments<T>& a, const Fold& fold, int component) {
  const T* const velocity = a.walls_at_rest ? nullptr : a.wall_velocity[fold.axis][fold.side];
  return velocity ? velocity[component * (a.node_count / a.extent[fold.axis]) + fold.line] : T(0);
}

/// Calls body(fold) for every node of the lines along a.axis that lies beyond an end and has a mirror or image: the
/// outermost first when folding, since in a domain of few cells its mirror is a ghost too; last when filling. With
/// `on_walls` also for those on a wall, which are their own mirrors.
template <int D, class T, class Body>
MPM_HD void for_each_fold(const Team& team, const Arguments<T>& a, bool outermost_first, bool on_walls, Body body) {
  const int axis = a.axis, extent = a.extent[axis], padding = a.padding[axis], cells = a.cells[axis];
  int stride = 1;
  for (int c = 0; c < axis; ++c) stride *= a.extent[c];
  for_each_index(team, a.node_count / extent, [&](int line) {
    const int origin = line / stride * stride * extent + line % stride + padding * stride;  // node 0 of the line
    for (int k = 0; k < 2 * (padding + 1); ++k) {
      const int at = outermost_first ? k : 2 * padding + 1 - k;
      const int beyond = padding - at / 2, side = at % 2, wall = a.walls[axis][side];
      const int i = side == 0 ? -beyond : cells + beyond;
      const int mirror = has_images(wall) ? image_of(i, cells, wall == wall_periodic) : i;
      if (mirror != i || (on_walls && beyond == 0 && folds(wall)))
        body(Fold{origin + i * stride, origin + mirror * stride, axis, side, wall, line});
    }
  });
}

/// Adds a ghost's values of one field to its mirror's by the field's rule, and clears them. `mass` is the ghost's.
template <class F, class T>
MPM_HD void fold_field(const Arguments<T>& a, const Fold& fold, T mass) {
  for (int c = 0; c < F::components; ++c) {
    T* const values = a.grid.field[F::number] + c * a.node_count;
    T of_wall = T(0);
    if constexpr (F::at_wall == rule_momentum) of_wall = mass * velocity_of_wall(a, fold, c);
    const T sign = T(mirror_sign(F::at_wall, fold.wall, false, fold.axis, c));
    values[fold.mirror] += mirrored(values[fold.ghost], sign, of_wall);
    values[fold.ghost] = T(0);
  }
}

/// Adds what is folded with the masses along a.axis to the mirrors, and marks the ghosts. A separating wall folds while
/// the pair approaches it, by p + dt f.
template <class Scene>
MPM_HD void fold_masses(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  for_each_fold<D>(team, a, true, !a.remap, [&](const Fold& fold) {
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
    if (fold.ghost != fold.mirror) a.grid.folded[fold.ghost] |= 1 << fold.axis;
    if constexpr (N::folded_mass >= 0) a.grid.field[N::folded_mass][fold.ghost] = mass;
    Scene::for_each_node_field([&](auto field) {
      using F = decltype(field);
      if constexpr (F::folded == folded_with_mass) {
        if (a.remap && F::number != N::mass && F::number != N::momentum) return;
        if (fold.ghost != fold.mirror)
          fold_field<F>(a, fold, mass);
        else if (F::at_wall == rule_slip)  // the image takes away what points across the wall
          a.grid.field[F::number][fold.axis * a.node_count + fold.ghost] = T(0);
      }
    });
  });
}

/// The same for forces, along the folds that were made.
template <class Scene>
MPM_HD void fold_forces(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_fold<Scene::dimension>(team, a, true, false, [&](const Fold& fold) {
    if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
    Scene::for_each_node_field([&](auto field) {
      using F = decltype(field);
      if constexpr (F::folded == folded_with_force) fold_field<F>(a, fold, T(0));
    });
  });
}

/// Gives ghosts the mirrored velocities, and the mirrored change of them.
template <class Scene>
MPM_HD void fill_velocities(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_fold<Scene::dimension>(team, a, false, false, [&](const Fold& fold) {
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

/// v = p / m. A node without mass is at rest.
template <class Scene>
MPM_HD void divide(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_index(team, Scene::dimension * a.node_count, [&](int at) {
    const T mass = a.grid.field[N::mass][at % a.node_count];
    a.grid.field[N::velocity][at] = mass > T(0) ? velocity_of(a.grid.field[N::momentum][at], mass) : T(0);
  });
}

/// v- <- v.
template <class Scene>
MPM_HD void keep_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  if constexpr (N::velocity_before >= 0)
    for_each_index(team, Scene::dimension * a.node_count,
                   [&](int at) { a.grid.field[N::velocity_before][at] = a.grid.field[N::velocity][at]; });
}

/// v += dt f / m; nothing is held any more.
template <class Scene>
MPM_HD void accelerate(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_index(team, a.node_count, [&](int node) {
    const T mass = a.grid.field[N::mass][node];
    if (a.grid.held) a.grid.held[node] = 0;
    for (int at = node; at < Scene::dimension * a.node_count; at += a.node_count) {
      T& velocity = a.grid.field[N::velocity][at];
      velocity = mass > T(0) ? accelerated(velocity, total_force<Scene>(a, at), mass, T(0), a.dt) : T(0);
    }
  });
}

/// Index of a node among those of a box.
template <int D, class T>
MPM_HD int index_in_box(const Box<T>& box, const int* node) {
  int index = 0;
  for (int c = D - 1; c >= 0; --c) index = index * (box.upper[c] - box.lower[c] + 1) + node[c] - box.lower[c];
  return index;
}
template <int D, class T>
MPM_HD int nodes_of_box(const Box<T>& box) {
  int count = 1;
  for (int c = 0; c < D; ++c) count *= box.upper[c] - box.lower[c] + 1;
  return count;
}

/// Sets the velocities that walls and boxes give; where several do, the last of them, boxes after walls. All decide by
/// the velocity as it was.
template <class Scene>
MPM_HD void impose_conditions(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.node_count, [&](int node) {
    if (!(a.grid.field[N::mass][node] > T(0))) return;
    const Vec<D, T> now = load<D>(a.grid.field[N::velocity], a.node_count, node);
    Vec<D, T> velocity = now;
    int held = 0, at[D];
    for (int axis = 0, rest = node; axis < D; rest /= a.extent[axis], ++axis)
      at[axis] = rest % a.extent[axis] - a.padding[axis];
    for (int axis = 0, stride = 1; axis < D; stride *= a.extent[axis], ++axis)
      for (int side = 0; side < 2; ++side) {
        if (at[axis] != (side == 0 ? 0 : a.cells[axis])) continue;
        const Fold foot{
            node, node, axis, side, a.walls[axis][side], node / (stride * a.extent[axis]) * stride + node % stride};
        for (int c = 0; c < D; ++c)
          if (wall_holds(foot.wall, axis, side, c, now[axis]))
            velocity[c] = velocity_of_wall(a, foot, c), held |= 1 << c;
      }
    for (int k = 0; k < a.box_count; ++k) {
      const Box<T>& box = a.boxes[k];
      bool inside = true;
      for (int c = 0; c < D; ++c) inside = inside && at[c] >= box.lower[c] && at[c] <= box.upper[c];
      if (!inside) continue;
      for (int c = 0; c < D; ++c)
        if (box_holds(box.type, box.axis, box.side, box.given, c, now[c])) {
          velocity[c] = box.velocity ? box.velocity[c * nodes_of_box<D>(box) + index_in_box<D>(box, at)] : T(0);
          held |= 1 << c;
        }
    }
    if (held == 0) return;
    store(a.grid.field[N::velocity], a.node_count, node, velocity);
    if (a.after_forces && a.grid.held) a.grid.held[node] |= held;
  });
}

}  // namespace mpm::device
