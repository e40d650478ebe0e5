#pragma once
// Regions that bodies fill. Lengths in m; in 2-D the z component is ignored.

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "experiment/vector3.hpp"

namespace mpm {

class Geometry {
 public:
  virtual ~Geometry() = default;
  /// Whether a point lies in the region; boundary points count as inside.
  virtual bool contains(const Vector3& point) const = 0;
  /// Lower and upper corner of a box around the region; infinite where it has no bound (a half space: the caller
  /// clips).
  virtual std::pair<Vector3, Vector3> bounds() const = 0;
  /// The smallest radius of the surfaces that are curved, m; infinite where none is.
  virtual double smallest_radius() const { return std::numeric_limits<double>::infinity(); }
};

using GeometryPointer = std::shared_ptr<const Geometry>;

/// Makers of regions. All take `dimension` (2 or 3) so that bounds and distances ignore z in 2-D. Arguments are assumed
/// checked: see crossing_edges and polygon_area for polygons; radii positive, lower < upper.
GeometryPointer make_ball(int dimension, const Vector3& centre, double radius);
GeometryPointer make_box(int dimension, const Vector3& lower, const Vector3& upper);
/// An annulus in 2-D; in 3-D a tube of `length` about an axis (0 x, 1 y, 2 z) through its centre.
GeometryPointer make_ring(int dimension, const Vector3& centre, double inner, double outer, int axis, double length);
GeometryPointer make_polygon(std::vector<Vector3> points);
/// The side of the plane through `point` that `normal` points away from.
GeometryPointer make_half_space(int dimension, const Vector3& point, const Vector3& normal);
GeometryPointer make_union(std::vector<GeometryPointer> parts);
GeometryPointer make_intersection(std::vector<GeometryPointer> parts);
/// The first part without the others.
GeometryPointer make_difference(std::vector<GeometryPointer> parts);

/// Two edges (by their first point's index) of a closed polygon that cross or touch; {-1, -1} when it is simple.
std::pair<int, int> crossing_edges(const std::vector<Vector3>& points);
/// Signed area of a closed polygon, m^2.
double polygon_area(const std::vector<Vector3>& points);

}  // namespace mpm
