#pragma once
// Walls, boxes of nodes and grips give the velocities of nodes, and supports take the impulses of it.

#include "backends/device/kernels/reactions.hpp"

namespace mpm::device {

template <int D, class AnyBox>
MPM_HD bool is_inside(const AnyBox& box, const int* node) {
  bool inside = true;
  for (int c = 0; c < D; ++c) inside = inside && node[c] >= box.lower[c] && node[c] <= box.upper[c];
  return inside;
}
/// The index of a node among those of a box.
template <int D, class AnyBox>
MPM_HD int index_in_box(const AnyBox& box, const int* node) {
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

/// Notes an impulse on one component of a node where conditions or contact apply it; `standing` is -1 where no filter
/// may take it back.
template <int impulse, int standing, class T>
MPM_HD void note_impulse(const Arguments<T>& a, const NodeArrays<T>& grid, int at, T given) {
  if constexpr (impulse >= 0) {
    if (!a.records) return;
    grid.field[impulse][at] += given;
    if constexpr (standing >= 0) grid.field[standing][at] += given;
  }
}

/// Calls give(support, component, value) for what walls, boxes and grips give a node with mass, in the order in which they
/// hold: the last one counts. All decide by the velocity as it is.
template <class Scene, class Give, class T = typename Scene::Scalar>
MPM_HD void for_each_hold(const Arguments<T>& a, int node, Give give) {
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  const T mass = a.grid.field[N::mass][node];
  const Vec<D, T> now = load<D>(a.grid.field[N::velocity], a.node_count, node);
  int at[D];
  coordinates_of_node<D>(a, node, at);
  for_each_wall_of_node<D>(a, node, at, [&](const Fold& foot) {
    for (int c = 0; c < D; ++c)
      if (wall_holds(foot.wall, foot.axis, foot.side, c, now[foot.axis]))
        give(2 * foot.axis + foot.side, c, velocity_of_wall(a, foot, c));
  });
  for (int k = 0; k < a.box_count; ++k) {
    const Box<T>& box = a.boxes[k];
    if (!is_inside<D>(box, at)) continue;
    for (int c = 0; c < D; ++c)
      if (box_holds(box.type, box.axis, box.side, box.given, c, now[c]))
        give(box.support, c, box.velocity ? box.velocity[c * nodes_of_box<D>(box) + index_in_box<D>(box, at)] : T(0));
  }
  for (int k = 0; k < a.grip_count; ++k) {
    const GripArrays<T>& grip = a.grips[k];
    if (!grip_holds(grip.mass[node], mass)) continue;
    const T* const momentum = a.grips_at_end ? grip.momentum : grip.before;
    for (int c = 0; c < D; ++c)
      if (grip.given >> c & 1) give(grip.support, c, momentum[c * a.node_count + node] / grip.mass[node]);
  }
}

/// Sets the velocities that walls, boxes and grips give.
template <class Scene>
MPM_HD void impose_conditions(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  for_each_node(team, a, [&](int node) {
    if (!(a.grid.field[N::mass][node] > T(0))) return;
    const Vec<D, T> now = load<D>(a.grid.field[N::velocity], a.node_count, node);
    Vec<D, T> velocity = now;
    bool held = false;
    for_each_hold<Scene>(a, node, [&](int, int c, T value) { velocity[c] = value, held = true; });
    if (!held) return;
    store(a.grid.field[N::velocity], a.node_count, node, velocity);
    for (int c = 0; c < D; ++c)
      note_impulse<N::boundary_impulse, N::standing_boundary_impulse>(
          a, a.grid, c * a.node_count + node, a.grid.field[N::mass][node] * (velocity[c] - now[c]));
  });
}

/// Sums what the support a.support is about to give the nodes. Of several that hold a component the last one gives all of
/// its impulse.
template <class Scene>
MPM_HD void held(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  sum_over_nodes<support_sums>(team, a, [&](int node, double* sums) {
    const double mass = a.grid.field[N::mass][node];
    if (!(mass > 0)) return;
    int holder[D];
    T given[D];
    for (int c = 0; c < D; ++c) holder[c] = -1, given[c] = T(0);
    for_each_hold<Scene>(a, node, [&](int support, int c, T value) { holder[c] = support, given[c] = value; });
    double impulse[3] = {}, place[3];
    for (int c = 0; c < D; ++c)
      if (holder[c] == a.support)
        impulse[c] = mass * (double(given[c]) - double(a.grid.field[N::velocity][c * a.node_count + node]));
    place_of_node<D>(a, node, place);
    add_impulse(sums, sums + 3, place, impulse);
  });
}

}  // namespace mpm::device
