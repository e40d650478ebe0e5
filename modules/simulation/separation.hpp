#pragma once
// The plane between two clouds of points: where it runs, how wide the gap is.

#include <cstdint>
#include <span>
#include <vector>

#include "experiment/vector3.hpp"

namespace mpm {

/// Points of one body near a node, by their numbers in an array that all nodes share. Lengths are in any one unit.
struct PointCloud {
  const Vector3* points = nullptr;
  std::span<const std::uint32_t> numbers;

  std::size_t size() const { return numbers.size(); }
  const Vector3& operator[](std::size_t i) const { return points[numbers[i]]; }
};

/// A plane with all of one cloud on one side and all of the other on the other.
struct SeparatingPlane {
  bool found = false;
  Vector3 normal{};  ///< unit, from a to b
  double gap = 0;    ///< the distance along it between the clouds' nearest points, in the points' unit
};

/// The plane with the widest gap between two clouds in `dimension` axes: its normal joins the nearest points of their
/// convex hulls, which a body's edge does not tilt as it tilts a gradient. The nearest points by Gilbert, Johnson &
/// Keerthi, IEEE J. Robot. Autom. 4 (1988) 193-203; that no plane has a wider gap by Cortes & Vapnik, Mach. Learn. 20
/// (1995) 273-297. Nothing is found where a cloud is empty or the hulls meet.
SeparatingPlane widest_gap(const PointCloud& a, const PointCloud& b, int dimension);

}  // namespace mpm
