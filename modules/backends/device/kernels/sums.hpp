#pragma once
// Sums over nodes and particles in double precision: a team adds its lanes in shared memory, the host adds the teams.

#include "backends/device/kernels/arrays.hpp"

namespace mpm::device {

/// The lanes of a reduction that shared memory has room for.
inline constexpr int largest_team = 256;

/// The room in shared memory for `count` sums a lane.
template <class Scene, int count>
inline constexpr int sum_scalars = count* largest_team* static_cast<int>(sizeof(double) /
                                                                         sizeof(typename Scene::Scalar));

/// Sets partial_sums[team][Count] to sums over the team's share of 0 .. count - 1, to which body(index, sums) adds.
template <int Count, class T, class Body>
MPM_HD void sum_over(const Team& team, const Arguments<T>& a, int count, Body body) {
  double* const of_lane = team.template shared<double>();
  team.for_each_lane([&](int lane) {
    double sums[Count] = {};
    const int index = team.block() * team.lanes() + lane;
    if (index < count) body(index, sums);
    for (int k = 0; k < Count; ++k) of_lane[lane * Count + k] = sums[k];
  });
  team.for_each_lane([&](int lane) {
    for (int k = lane; k < Count; k += team.lanes()) {
      double sum = 0;
      for (int other = 0; other < team.lanes(); ++other) sum += of_lane[other * Count + k];
      a.partial_sums[team.block() * Count + k] = sum;
    }
  });
}

}  // namespace mpm::device
