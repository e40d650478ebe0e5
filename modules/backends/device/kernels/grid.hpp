#pragma once
// The grid between scatter and gather: walls and periodic images by the mirror fold of simulation/boundary.hpp, momenta
// to velocities, forces. A fold runs along the lines of one axis, a lane a line: nothing is written by two lanes.

#include "backends/device/kernels/arrays.hpp"

namespace mpm::device {

/// All channels to zero; for the remap of MUSL masses, momenta and velocities only.
template <class Scene>
MPM_HD void clear(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.node_count, [&](int node) {
    const Vec<D, T> zero{};
    const auto clear_vector = [&](T* channel) {
      if (channel) store(channel, a.node_count, node, zero);
    };
    a.grid.mass[node] = T(0);
    a.grid.folded[node] = 0;
    clear_vector(a.grid.momentum), clear_vector(a.grid.velocity), clear_vector(a.grid.constrained);
    if (a.remap) return;
    clear_vector(a.grid.force), clear_vector(a.grid.velocity_before);
    if (a.grid.volume) a.grid.volume[node] = T(0);
    clear_vector(a.grid.volume_gradient), clear_vector(a.grid.mass_position);
  });
}

/// A ghost beyond the wall (or image) at one end of a line, and the node that it is folded onto.
struct Fold {
  int ghost, mirror, axis, side;
  int wall;
};

/// Sign with which component `component` of a vector is mirrored.
MPM_HD int mirror_sign(int wall, int axis, int component) {
  if (wall == wall_periodic) return 1;
  if (wall == wall_stick || wall == wall_prescribed) return -1;
  return component == axis ? -1 : 1;
}
MPM_HD bool folds(int wall) {
  return wall != wall_free && wall != wall_periodic;
}

template <int D, class T>
MPM_HD void add_mirrored(T* channel, int nodes, const Fold& fold, int wall, bool remove) {
  for (int c = 0; c < D; ++c) {
    T& ghost = channel[c * nodes + fold.ghost];
    channel[c * nodes + fold.mirror] += T(mirror_sign(wall, fold.axis, c)) * ghost;
    if (remove) ghost = T(0);
  }
}
template <int D, class T>
MPM_HD void take_mirrored(T* channel, int nodes, const Fold& fold) {
  for (int c = 0; c < D; ++c)
    channel[c * nodes + fold.ghost] = T(mirror_sign(fold.wall, fold.axis, c)) * channel[c * nodes + fold.mirror];
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
      int mirror = i;
      if (wall == wall_periodic)
        mirror = ((i % cells) + cells) % cells;
      else if (folds(wall))
        mirror = side == 0 ? beyond : cells - beyond;
      if (mirror != i || (on_walls && beyond == 0 && folds(wall)))
        body(Fold{origin + i * stride, origin + mirror * stride, axis, side, wall});
    }
  });
}

/// Adds masses, momenta and contact channels of ghosts along a.axis to their mirrors, and marks the ghosts. A
/// separating wall folds while the pair approaches it, by p + dt f.
template <class Scene>
MPM_HD void fold_masses(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  constexpr int D = Scene::dimension;
  const GridArrays<T>& g = a.grid;
  const int nodes = a.node_count;
  const bool fold_contact = g.volume && !a.remap;
  for_each_fold<D>(team, a, true, fold_contact, [&](const Fold& fold) {
    if (!(g.mass[fold.ghost] > T(0))) return;
    if (fold.wall == wall_separate) {
      const T dt = a.remap ? T(0) : a.dt;
      const auto inward = [&](int node) {
        const int at = fold.axis * nodes + node;
        const T speed = g.mass[node] > T(0) ? (g.momentum[at] + dt * g.force[at]) / g.mass[node] : T(0);
        return fold.side == 0 ? speed : -speed;
      };
      if (!(inward(fold.ghost) + inward(fold.mirror) < T(0))) return;
    }
    if (fold.ghost == fold.mirror) {  // the image takes away what of the contact channels points across the wall
      g.volume_gradient[fold.axis * nodes + fold.ghost] = g.mass_position[fold.axis * nodes + fold.ghost] = T(0);
      return;
    }
    g.mass[fold.mirror] += g.mass[fold.ghost];
    g.mass[fold.ghost] = T(0);
    add_mirrored<D>(g.momentum, nodes, fold, fold.wall, true);
    g.folded[fold.ghost] |= 1 << fold.axis;
    if (!fold_contact) return;
    const int as = fold.wall == wall_periodic ? wall_periodic : wall_slip;
    g.volume[fold.mirror] += g.volume[fold.ghost];
    add_mirrored<D>(g.volume_gradient, nodes, fold, as, false);
    add_mirrored<D>(g.mass_position, nodes, fold, as, false);
  });
}

/// The same for forces, along the folds that were made.
template <class Scene>
MPM_HD void fold_forces(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_fold<Scene::dimension>(team, a, true, false, [&](const Fold& fold) {
    if (a.grid.folded[fold.ghost] >> fold.axis & 1)
      add_mirrored<Scene::dimension>(a.grid.force, a.node_count, fold, fold.wall, true);
  });
}

/// Gives ghosts the mirrored velocities.
template <class Scene>
MPM_HD void fill_velocities(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_fold<Scene::dimension>(team, a, false, false, [&](const Fold& fold) {
    if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
    take_mirrored<Scene::dimension>(a.grid.velocity, a.node_count, fold);
    take_mirrored<Scene::dimension>(a.grid.velocity_before, a.node_count, fold);
  });
}

/// Sets the momenta that walls hold: zero across them, and along them where they stick. A separating wall holds what
/// moves into it.
template <class Scene>
MPM_HD void impose_walls(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.node_count, [&](int node) {
    if (!(a.grid.mass[node] > T(0))) return;
    bool held[D] = {};
    for (int axis = 0, rest = node; axis < D; rest /= a.extent[axis], ++axis) {
      const int at = rest % a.extent[axis] - a.padding[axis];
      for (int side = 0; side < 2; ++side) {
        const int wall = a.walls[axis][side];
        if (!folds(wall) || at != (side == 0 ? 0 : a.cells[axis])) continue;
        const T across = a.grid.momentum[axis * a.node_count + node];
        if (wall == wall_separate && (side == 0 ? across >= T(0) : across <= T(0))) continue;
        for (int c = 0; c < D; ++c) held[c] = held[c] || mirror_sign(wall, axis, c) < 0;
      }
    }
    for (int c = 0; c < D; ++c)
      if (held[c]) a.grid.momentum[c * a.node_count + node] = T(0);
  });
}

/// v = p / m; v- too, but for the remap. A node without mass is at rest.
template <class Scene>
MPM_HD void momentum_to_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.node_count, [&](int node) {
    const T mass = a.grid.mass[node];
    Vec<D, T> v{};
    if (mass > T(0)) {
      v = load<D>(a.grid.momentum, a.node_count, node);
      for (int c = 0; c < D; ++c) v[c] = v[c] / mass;
    }
    store(a.grid.velocity, a.node_count, node, v);
    if (!a.remap) store(a.grid.velocity_before, a.node_count, node, v);
  });
}

/// v+ = p / m.
template <class Scene>
MPM_HD void update_velocity(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  for_each_index(team, a.node_count, [&](int node) {
    const T mass = a.grid.mass[node];
    for (int at = node; at < Scene::dimension * a.node_count; at += a.node_count)
      a.grid.velocity[at] = mass > T(0) ? a.grid.momentum[at] / mass : T(0);
  });
}

/// p += dt f.
template <class Scene>
MPM_HD void accelerate(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  for_each_index(team, Scene::dimension * a.node_count,
                 [&](int at) { a.grid.momentum[at] += a.dt * a.grid.force[at]; });
}

}  // namespace mpm::device
