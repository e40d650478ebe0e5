#pragma once
// Ghosts fold onto their mirrors along the lines of one axis, a lane a line, so that nothing is written by two lanes.
// Walls give velocity, temperature and heat there.

#include "backends/device/kernels/active_nodes.hpp"
#include "backends/device/kernels/arrays.hpp"
#include "operators/edges.hpp"
#include "operators/heat.hpp"

namespace mpm::device {

/// A ghost beyond the wall (or image) at one end of a line, and the node that it is folded onto.
struct Fold {
  int ghost, mirror, axis, side;
  int wall, line;
  int foot, inward;  ///< line's node on the wall, and how much farther the index of the next one inward is
  int beyond;        ///< cells from there to the ghost
};

/// The velocity of the wall at the foot of a fold's ghost.
template <class T>
MPM_HD T velocity_of_wall(const Arguments<T>& a, const Fold& fold, int component) {
  const T* const velocity = a.walls_at_rest ? nullptr : a.wall_velocity[fold.axis][fold.side];
  return velocity ? velocity[component * (a.node_count / a.extent[fold.axis]) + fold.line] : T(0);
}

/// The node on the wall at one end of a line along a.axis, as a fold onto itself.
template <class T>
MPM_HD Fold foot_of_line(const Arguments<T>& a, int line, int side) {
  int stride = 1;
  for (int c = 0; c < a.axis; ++c) stride *= a.extent[c];
  const int first = line / stride * stride * a.extent[a.axis] + line % stride;
  const int foot = first + (a.padding[a.axis] + (side == 0 ? 0 : a.cells[a.axis])) * stride;
  return {foot, foot, a.axis, side, a.walls[a.axis][side], line, foot, side == 0 ? stride : -stride, 0};
}

/// Calls body(fold) for every active node of a line along a.axis that lies beyond an end and has a mirror or image: the
/// outermost first when folding, since in a domain of few cells its mirror is a ghost too; last when filling. With
/// `on_walls` it is also called for nodes on a wall, which are their own mirrors.
template <class T, class Body>
MPM_HD void for_each_fold_of_line(const Arguments<T>& a, int line, bool outermost_first, bool on_walls, Body body) {
  const int axis = a.axis, padding = a.padding[axis], cells = a.cells[axis];
  for (int k = 0; k < 2 * (padding + 1); ++k) {
    const int at = outermost_first ? k : 2 * padding + 1 - k;
    const int beyond = padding - at / 2, side = at % 2, wall = a.walls[axis][side];
    const int i = side == 0 ? -beyond : cells + beyond;
    const int mirror = has_images(wall) ? image_of(i, cells, wall == wall_periodic) : i;
    if (mirror == i && !(on_walls && beyond == 0 && folds(wall))) continue;
    Fold fold = foot_of_line(a, line, side);
    const int upward = side == 0 ? fold.inward : -fold.inward, origin = fold.foot - (side == 0 ? 0 : cells) * upward;
    fold.ghost = origin + i * upward, fold.mirror = origin + mirror * upward, fold.beyond = beyond;
    if (is_active_by_now(a.grid, fold.ghost)) body(fold);
  }
}

/// Does the same for all lines, a lane a line.
template <class T, class Body>
MPM_HD void for_each_fold(const Team& team, const Arguments<T>& a, bool outermost_first, bool on_walls, Body body) {
  for_each_index(team, a.node_count / a.extent[a.axis],
                 [&](int line) { for_each_fold_of_line(a, line, outermost_first, on_walls, body); });
}

/// Calls body(foot) for every wall that a node stands on, to find what the wall gives there.
template <int D, class T, class Body>
MPM_HD void for_each_wall_of_node(const Arguments<T>& a, int index, const int* node, Body body) {
  for (int axis = 0, stride = 1; axis < D; stride *= a.extent[axis], ++axis)
    for (int side = 0; side < 2; ++side)
      if (node[axis] == (side == 0 ? 0 : a.cells[axis]))
        body(Fold{index, index, axis, side, a.walls[axis][side],
                  index / (stride * a.extent[axis]) * stride + index % stride, index, side == 0 ? stride : -stride, 0});
}

// ---- heat at walls -----------------------------------------------------------------------------------------------

template <class T>
MPM_HD bool holds_temperature(const Arguments<T>& a, const Fold& fold) {
  return fold.wall != wall_periodic && a.wall_temperature[fold.axis][fold.side];
}
/// The temperature that the wall is held at, at the foot of a fold's ghost.
template <class T>
MPM_HD T temperature_of_wall(const Arguments<T>& a, const Fold& fold) {
  return holds_temperature(a, fold) ? a.wall_temperature[fold.axis][fold.side][fold.line] : T(0);
}

/// The sum of w C (x_p - x_i) of a node along the inward normal, J m/K, where the transfer scatters no particle gradients.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T capacity_inward([[maybe_unused]] const Arguments<T>& a, [[maybe_unused]] const Fold& fold,
                         [[maybe_unused]] int node) {
  using N = typename Scene::Node;
  if constexpr (N::capacity_position >= 0) {
    const T along = a.grid.field[N::capacity_position][fold.axis * a.node_count + node];
    return fold.side == 0 ? along : -along;
  } else {
    return T(0);
  }
}

/// The flux into the body at the foot of a fold where heat comes through the wall, W/m^2. Convection goes by the
/// temperature there, which is that of nodes whose heat is `divided`, or what it will be when this has been folded and
/// divided.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T flux_through_wall(const Arguments<T>& a, const Fold& fold, bool divided) {
  using N = typename Scene::Node;
  const WallHeat<T>& wall = a.wall_heat[fold.axis][fold.side];
  const T given = wall.value[fold.line];
  if (!(wall.coefficient > T(0))) return given;
  const T conductivity = a.grid.field[N::volume_conductivity][fold.foot] / a.grid.field[N::heated_volume][fold.foot];
  T at_wall = T(0), beyond = a.wall_beyond;
  for (int k = 0; k < a.wall_share_count; ++k) {
    const int node = fold.foot + k * fold.inward, ghost = fold.foot - k * fold.inward;
    if (divided) {
      at_wall += a.wall_shares[k] * a.grid.field[N::temperature][node];
      continue;
    }
    // Folding adds the ghost's heat, and what a gradient makes of its image; the wall's node has half of its own.
    T heat = a.grid.field[N::heat][node], capacity = a.grid.field[N::heat_capacity][node];
    const T capacity_of_ghost = k == 0 ? T(0) : a.grid.field[N::heat_capacity][ghost];
    T image = heat_beyond_wall(T(1), a.cell_size * T(k), capacity_of_ghost, capacity_inward<Scene>(a, fold, ghost));
    if (k == 0)
      image *= T(0.5);
    else
      heat += a.grid.field[N::heat][ghost], capacity += capacity_of_ghost;
    if (!(capacity > T(0))) continue;
    at_wall += a.wall_shares[k] * (heat / capacity);
    beyond -= a.wall_shares[k] * (image / capacity);
  }
  return convected_flux(wall.coefficient, given, at_wall, beyond, conductivity);
}

/// The rise of the temperature inward at a wall that heat comes through, by Fourier's law, K/m; else zero.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T gradient_at_wall([[maybe_unused]] const Arguments<T>& a, [[maybe_unused]] const Fold& fold,
                          [[maybe_unused]] bool divided) {
  using N = typename Scene::Node;
  if constexpr (N::heated_volume >= 0) {
    const T volume = a.grid.field[N::heated_volume][fold.foot];
    if (fold.wall == wall_periodic || !a.wall_heat[fold.axis][fold.side].value || !(volume > T(0))) return T(0);
    return -flux_through_wall<Scene>(a, fold, divided) * volume / a.grid.field[N::volume_conductivity][fold.foot];
  } else {
    return T(0);
  }
}

/// The heat that the mirror gets beyond what the ghost's own and a held temperature make of the image, by the gradient
/// before anything of the line was folded; a node on the wall is its own mirror and gets half of it.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T heat_of_image(const Arguments<T>& a, const Fold& fold, T heat_capacity, T gradient) {
  const T more = heat_beyond_wall(gradient, a.cell_size * T(fold.beyond), heat_capacity,
                                  capacity_inward<Scene>(a, fold, fold.ghost));
  return fold.ghost == fold.mirror ? T(0.5) * more : more;
}

}  // namespace mpm::device
