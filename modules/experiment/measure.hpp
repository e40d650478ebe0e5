#pragma once
// Volumes and middles of the parts of a region that lie in boxes, from distances to its surface.

#include <functional>

#include "experiment/geometry.hpp"

namespace mpm {

/// A part of a region, small enough to stand for its place.
struct Piece {
  Vector3 middle{};   ///< m, in the frame of the box
  double volume = 0;  ///< m^dimension
};

/// Cuts a box, given in a frame, into halves along every axis, up to `depth` times where the surface passes; the last
/// boxes hold what lies behind the plane that is there the surface, so that volumes change without jumps as the region
/// moves; where it has an edge they are cut twice more. Boxes that lie inside are one piece, or with `evenly` as small as the others.
void for_each_piece(const Geometry& region, int dimension, const Frame& frame, const Vector3& lower,
                    const Vector3& upper, int depth, bool evenly, const std::function<void(const Piece&)>& visit);

/// What of a region lies in a box.
struct Measured {
  double volume = 0;   ///< m^dimension
  Vector3 moment{};    ///< integral of the place in the frame, m^(dimension + 1)
  Vector3 second{};    ///< integral of its squares, m^(dimension + 2)
  bool whole = false;  ///< all of the box

  void add(const Measured& other);
  Vector3 middle() const { return {moment[0] / volume, moment[1] / volume, moment[2] / volume}; }
};
Measured measure(const Geometry& region, int dimension, const Frame& frame, const Vector3& lower, const Vector3& upper,
                 int depth);

/// The share of the unit square or cube about 0 where d + slope . x <= 0.
double share_behind_plane(int dimension, double d, const Vector3& slope);

}  // namespace mpm
