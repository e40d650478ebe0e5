#pragma once
// Phases over nodes leave out those that no particle has reached since the grid was last forgotten. Nodes are noted in runs
// of neighbours, so that lanes next to each other still read memory next to each other. All fields of a run that is not
// noted are zero. Scatters note the runs that they give to, folds those of the mirrors.

#include "backends/device/kernels/arguments.hpp"
#include "backends/device/kernels/team.hpp"

namespace mpm::device {

/// Whether any particle, or image, has reached the nodes around this one; for phases that note no nodes themselves.
template <class T>
MPM_HD bool is_active(const NodeArrays<T>& grid, int node) {
  return grid.active[node / nodes_of_run] != 0;
}
/// The same for phases whose other lanes may note nodes meanwhile.
template <class T>
MPM_HD bool is_active_by_now(const NodeArrays<T>& grid, int node) {
  return Team::look(grid.active + node / nodes_of_run) != 0;
}

/// Notes that something is given to a node.
template <class T>
MPM_HD void note_active(const NodeArrays<T>& grid, int node) {
  if (!is_active_by_now(grid, node)) Team::put(grid.active + node / nodes_of_run, static_cast<unsigned char>(1));
}

/// Calls body(node) for all active nodes of a.grid, a lane a node.
template <class T, class Body>
MPM_HD void for_each_node(const Team& team, const Arguments<T>& a, Body body) {
  for_each_index(team, a.node_count, [&](int node) {
    if (is_active(a.grid, node)) body(node);
  });
}

/// Calls body(at) for all components of vectors of `dimension` components at active nodes of a.grid.
template <int dimension, class T, class Body>
MPM_HD void for_each_component(const Team& team, const Arguments<T>& a, Body body) {
  for_each_index(team, dimension * a.node_count, [&](int at) {
    if (is_active(a.grid, at % a.node_count)) body(at);
  });
}

}  // namespace mpm::device
