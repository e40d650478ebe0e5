#pragma once
// Sums and largest values over nodes and particles, in double precision. A team joins its lanes in shared memory, and one
// team the teams; the order in which they are joined depends on the number of lanes alone.

#include "backends/device/kernels/active_nodes.hpp"
#include "backends/device/kernels/arrays.hpp"

namespace mpm::device {

/// The lanes of a reduction that shared memory has room for, and the values of one.
inline constexpr int largest_team = 256, most_sums = 17;

/// The room in shared memory for `count` values a lane.
template <class Scene, int count>
inline constexpr int sum_scalars = count* largest_team* static_cast<int>(sizeof(double) /
                                                                         sizeof(typename Scene::Scalar));

/// Adds the first values, and takes the larger one of each of the last `maxima`, which start from zero.
struct Adding {
  MPM_HD static void join(double* values, const double* more, int count, int maxima) {
    for (int k = 0; k < count - maxima; ++k) values[k] += more[k];
    for (int k = count - maxima; k < count; ++k) values[k] = more[k] > values[k] ? more[k] : values[k];
  }
};
/// Adds sums whose first value is the number of particles, and takes of each of the last `maxima` the larger one, or what
/// is not a number.
struct AddingParticles {
  MPM_HD static void join(double* values, const double* more, int count, int maxima) {
    if (!(more[0] > 0)) return;
    const bool first = !(values[0] > 0);
    for (int k = 0; k < count - maxima; ++k) values[k] += more[k];
    for (int k = count - maxima; k < count; ++k)
      if (first || more[k] > values[k] || more[k] != more[k]) values[k] = more[k];
  }
};
/// Takes all values of the one whose first is larger; the one before where they are equal.
struct TakingLargest {
  MPM_HD static void join(double* values, const double* more, int count, int) {
    if (!(more[0] > values[0])) return;
    for (int k = 0; k < count; ++k) values[k] = more[k];
  }
};

/// Joins the lanes' values in shared memory, [lane][count], neighbours first, and hands the outcome to `to`.
template <class Join>
MPM_HD void join_lanes(const Team& team, double* of_lane, int count, int maxima, double* to) {
  for (int apart = 1; apart < team.lanes(); apart *= 2)
    team.for_each_lane([&](int lane) {
      if (lane % (2 * apart) == 0 && lane + apart < team.lanes())
        Join::join(of_lane + lane * count, of_lane + (lane + apart) * count, count, maxima);
    });
  team.for_each_lane([&](int lane) {
    for (int k = lane; k < count; k += team.lanes()) to[k] = of_lane[k];
  });
}

/// Sets partial_sums[team][Count] to what the team's share of 0 .. count - 1 makes: body(index, values) changes values
/// that start from zero.
template <int Count, int Maxima = 0, class Join = Adding, class T, class Body>
MPM_HD void sum_over(const Team& team, const Arguments<T>& a, int count, Body body) {
  static_assert(Count <= most_sums, "partial_sums and add_teams have room for most_sums values");
  double* const of_lane = team.template shared<double>();
  team.for_each_lane([&](int lane) {
    double values[Count] = {};
    const int index = team.block() * team.lanes() + lane;
    if (index < count) body(index, values);
    for (int k = 0; k < Count; ++k) of_lane[lane * Count + k] = values[k];
  });
  join_lanes<Join>(team, of_lane, Count, Maxima, a.partial_sums + team.block() * Count);
}

/// Does the same over the active nodes of a.grid; the others give nothing.
template <int Count, class T, class Body>
MPM_HD void sum_over_nodes(const Team& team, const Arguments<T>& a, Body body) {
  sum_over<Count>(team, a, a.node_count, [&](int node, double* values) {
    if (is_active(a.grid, node)) body(node, values);
  });
}

/// Joins what all teams of the launch before have left in partial_sums, in one team, and hands it to a.sums.
template <class Join, class T>
MPM_HD void join_teams(const Team& team, const Arguments<T>& a) {
  double* const of_lane = team.template shared<double>();
  const int count = a.sum_count, each = (a.sum_teams + team.lanes() - 1) / team.lanes();
  team.for_each_lane([&](int lane) {
    double* const values = of_lane + lane * count;
    for (int k = 0; k < count; ++k) values[k] = 0;
    for (int other = lane * each; other < (lane + 1) * each && other < a.sum_teams; ++other)
      Join::join(values, a.partial_sums + other * count, count, a.sum_maxima);
  });
  join_lanes<Join>(team, of_lane, count, a.sum_maxima, a.sums);
}
template <class Scene>
MPM_HD void add_teams(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  join_teams<Adding>(team, a);
}
template <class Scene>
MPM_HD void largest_of_teams(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  join_teams<TakingLargest>(team, a);
}

}  // namespace mpm::device
