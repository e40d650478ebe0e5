#pragma once
// Regions that bodies fill. Lengths in m; in 2-D the z component is ignored.

#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "experiment/surface.hpp"
#include "experiment/vector3.hpp"

namespace mpm {

/// The lattice that suits a region: an origin and orthonormal axes. A lattice fills the region exactly where its faces lie
/// on planes across the axes, `lower` and `upper` from the origin along each axis, m; else it is centred on the origin.
struct Frame {
  Vector3 origin{};
  std::array<Vector3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  bool filled = false;
  Vector3 lower{}, upper{};

  Vector3 to_world(const Vector3& local) const;
  Vector3 to_local(const Vector3& point) const;
};

class Geometry {
 public:
  virtual ~Geometry() = default;
  /// Whether a point lies in the region; boundary points count as inside.
  virtual bool contains(const Vector3& point) const = 0;
  /// Lower and upper corner of a box around the region; infinite where it has no bound (a half space: the caller
  /// clips).
  virtual std::pair<Vector3, Vector3> bounds() const = 0;
  /// How far a point is from the surface, m, negative inside: at most that in size (a union's or an intersection's may be
  /// less), and continuous.
  virtual double distance(const Vector3& point) const = 0;
  /// The smallest and the largest of direction . x over the region, m, of a unit direction; infinite where it has no
  /// bound. An intersection's may be wider than the region.
  virtual std::pair<double, double> extent(const Vector3& direction) const = 0;
  /// The axes of the lattice that suits the region: along those of the grid, about the middle of its bounds, unless it
  /// knows better.
  virtual Frame frame() const;
  /// The smallest radius of the surfaces that are curved, m; infinite where none is.
  virtual double smallest_radius() const { return std::numeric_limits<double>::infinity(); }
  /// The boundary in pieces of at most `spacing`; of what has no bound, as far as it lies in the box `within`.
  virtual Surface surface(double spacing, const std::pair<Vector3, Vector3>& within) const = 0;
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

/// A region that holds nothing, at a point.
GeometryPointer make_nothing(const Vector3& point);

/// A region turned about a point by a rotation, of orthonormal rows, and then moved.
GeometryPointer make_placed(GeometryPointer part, const std::array<Vector3, 3>& rotation, const Vector3& about,
                            const Vector3& by);
/// The rotation by an angle, rad, about an axis of any length but zero; orthonormal rows.
std::array<Vector3, 3> rotation_about(const Vector3& axis, double angle);
/// The middle of a region's bounds; zero along axes on which it has none.
Vector3 middle_of(const Geometry& geometry);

/// Two edges (by their first point's index) of a closed polygon that cross or touch; {-1, -1} when it is simple.
std::pair<int, int> crossing_edges(const std::vector<Vector3>& points);
/// Signed area of a closed polygon, m^2.
double polygon_area(const std::vector<Vector3>& points);

}  // namespace mpm
