#pragma once
// Surfaces as small flat pieces, to integrate over: edges in 2-D, facets in 3-D. Areas of whole spheres, cylinders, rings
// and flat faces are exact; where one region cuts another the rim is known to a piece.

#include <functional>
#include <utility>
#include <vector>

#include "experiment/vector3.hpp"

namespace mpm {

struct SurfacePiece {
  Vector3 point{};   ///< centre, m
  Vector3 normal{};  ///< of length 1, out of the material
  double area = 0;   ///< m^2; in 2-D a length, m
};
using Surface = std::vector<SurfacePiece>;

/// Adds the pieces of a primitive, none longer than `spacing`. `side` is +1 where the normal points away from the centre
/// or the axis, -1 where it points to it.
void add_circle(Surface& surface, const Vector3& centre, double radius, int side, double spacing);
void add_sphere(Surface& surface, const Vector3& centre, double radius, double spacing);
void add_cylinder(Surface& surface, const Vector3& centre, double radius, int axis, double length, int side,
                  double spacing);
/// The flat end of a tube, at its upper (+1) or lower (-1) end.
void add_cap(Surface& surface, const Vector3& centre, double inner, double outer, int axis, double length, int end,
             double spacing);
void add_edge(Surface& surface, const Vector3& from, const Vector3& to, const Vector3& normal, double spacing);
/// All faces of a box.
void add_box(Surface& surface, int dimension, const Vector3& lower, const Vector3& upper, double spacing);
/// The plane through a point, as far as it lies in the box from `lower` to `upper`.
void add_plane(Surface& surface, int dimension, const Vector3& point, const Vector3& normal, const Vector3& lower,
               const Vector3& upper, double spacing);

/// Turns pieces of the parts of a region into those of the whole: a piece stays where the region lies on one side of it
/// alone, once where surfaces of several parts coincide, with its normal out of the region. `contains` asks the region,
/// `parts` its parts; pieces come in the order of the parts.
Surface surface_of_whole(const std::vector<Surface>& of_parts, const std::function<bool(const Vector3&)>& contains,
                         const std::vector<std::function<bool(const Vector3&)>>& parts, double spacing);

}  // namespace mpm
