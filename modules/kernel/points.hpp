#pragma once
// The particles near a node, as normals of contact look at them: a functor is written for any kind of cloud, as hosts keep
// particles in rows and devices in columns that lanes share. Device-safe.

#include "kernel/tensor.hpp"

namespace mpm {

/// The particles of two bodies that a node sees. A cloud holds those of one body, at least one, and has
///   for_each(visit)  calls visit(place, weight) for all of them, each time in the same order,
///   add(term, sums)  adds to sums[N] the values[N] that term(place, weight, values) writes for each of them. Hosts ask for
///                    several particles at once, so that term is a template of the scalar S: a place is then a Vec<3, S>,
///                    and the values of a weight 0 have to be 0, as there are lanes without a particle,
///   middle()         where they are about: a first guess alone depends on it,
///   farthest(along)  the place farthest along a direction, the first of several.
/// A place is a Vec<3, double>, in cells from the node; z is 0 in the plane. A weight is the quadratic B-spline's of the node at
/// the particle, 0 from 1.5 cells along an axis on.
template <class Cloud>
struct PointsOfPair {
  Cloud a, b;
};

}  // namespace mpm
