#pragma once
// What walls give by mirror images, where reactions are asked for: folding takes a ghost's momentum away and gives the
// image to its mirror, and particles gather from ghosts again. Sums go over the lines of an axis.

#include "backends/device/kernels/folds.hpp"
#include "backends/device/kernels/sums.hpp"
#include "operators/supports.hpp"

namespace mpm::device {

/// Sums of one support: impulse and its moment about the origin, three components each; and those of both walls of an
/// axis, the lower one first.
inline constexpr int support_sums = 6, wall_sums = 2 * support_sums;

/// The room in shared memory for a phase along lines.
template <class Scene>
inline constexpr int line_scalars = Scene::reactions ? sum_scalars<Scene, wall_sums> : 1;

/// Calls body(line, sums) for all lines along a.axis, a lane a line; `sums` is null in scenes without reactions.
template <class Scene, class Body, class T = typename Scene::Scalar>
MPM_HD void for_each_line(const Team& team, const Arguments<T>& a, Body body) {
  const int lines = a.node_count / a.extent[a.axis];
  if constexpr (Scene::reactions)
    sum_over<wall_sums>(team, a, lines, body);
  else
    for_each_index(team, lines, [&](int line) { body(line, static_cast<double*>(nullptr)); });
}

/// The coordinates of a node by its index.
template <int D, class T>
MPM_HD void coordinates_of_node(const Arguments<T>& a, int index, int* node) {
  for (int axis = 0; axis < D; index /= a.extent[axis], ++axis) node[axis] = index % a.extent[axis] - a.padding[axis];
}
/// Where it lies, m.
template <int D, class T>
MPM_HD void place_of_node(const Arguments<T>& a, int index, double* place) {
  int node[D];
  coordinates_of_node<D>(a, index, node);
  for (int c = 0; c < 3; ++c) place[c] = c < D ? double(a.lower[c]) + double(a.cell_size) * node[c] : 0.0;
}

/// Notes that the wall of a fold takes momentum, or force, away at one node and gives some at another.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD void note_moved(const Arguments<T>& a, const Fold& fold, int away, const double* from, int there,
                       const double* to, double* sums) {
  if (fold.wall == wall_periodic) return;
  double *const impulse = sums + support_sums * fold.side, *const moment = impulse + 3, place[3];
  place_of_node<Scene::dimension>(a, away, place);
  add_impulse(impulse, moment, place, from, -1);
  place_of_node<Scene::dimension>(a, there, place);
  add_impulse(impulse, moment, place, to);
}

/// Notes what folding a ghost of a mass does to a vector whose component c is value(c). A force is mirrored as if the mass
/// were zero.
template <class Scene, class T, class Value>
MPM_HD void note_image([[maybe_unused]] const Arguments<T>& a, [[maybe_unused]] const Fold& fold,
                       [[maybe_unused]] T mass, [[maybe_unused]] Value value, [[maybe_unused]] double* sums) {
  if constexpr (Scene::reactions) {
    double ghost[3] = {}, image[3] = {};
    for (int c = 0; c < Scene::dimension; ++c) {
      const T own = value(c);
      ghost[c] = own;
      image[c] = mirrored(own, T(mirror_sign(fold.wall, fold.axis, c)), mass * velocity_of_wall(a, fold, c));
    }
    note_moved<Scene>(a, fold, fold.ghost, ghost, fold.mirror, image, sums);
  }
}

/// What particles gather from ghosts: the velocity, its change by the forces, or a filter's increment.
enum : int { beyond_velocity = 0, beyond_change, beyond_increment };

/// Notes, as a.beyond says, that particles gather a ghost's value where its mirror's would be theirs without the wall.
template <class Scene>
MPM_HD void gathered_beyond(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  for_each_line<Scene>(team, a, [&](int line, [[maybe_unused]] double* sums) {
    for_each_fold_of_line(a, line, false, false, [&](const Fold& fold) {
      if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
      if constexpr (Scene::reactions) {
        const double mass = a.grid.field[N::folded_mass][fold.ghost];
        const auto of_node = [&](int node, double* value) {
          for (int c = 0; c < Scene::dimension; ++c) {
            const int at = c * a.node_count + node;
            if constexpr (N::increment >= 0)
              if (a.beyond == beyond_increment) {
                value[c] = mass * a.grid.field[N::increment][at];
                continue;
              }
            value[c] = mass * a.grid.field[N::velocity][at];
            if constexpr (N::velocity_before >= 0)
              if (a.beyond == beyond_change) value[c] -= mass * a.grid.field[N::velocity_before][at];
          }
        };
        double of_mirror[3] = {}, of_ghost[3] = {};
        of_node(fold.mirror, of_mirror), of_node(fold.ghost, of_ghost);
        note_moved<Scene>(a, fold, fold.mirror, of_mirror, fold.ghost, of_ghost, sums);
      }
    });
  });
}

}  // namespace mpm::device
