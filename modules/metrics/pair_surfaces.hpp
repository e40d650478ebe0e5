#pragma once
// What the surfaces of bodies tell of their contact where these are known: how far apart they are, and how far the normals
// of contact are from theirs.

#include <vector>

#include "metrics/probes.hpp"

namespace mpm {

/// Of one pair of velocity fields. Angles are NaN where no node has a force, or the bodies do not face each
/// other any more; all numbers are where a body has no affine motion of its own, as a single row of particles.
struct PairSurfaces {
  double normal_error = 0, largest_normal_error = 0;  ///< degrees
  double misfit = 0;                                  ///< m
  double gap = 0;                                     ///< m, negative where the bodies overlap
};

/// For each pair (pair_index) the gap between the surfaces, and the angle between the normal of contact at a node and that
/// of the surfaces that meet there. Surfaces are known from the geometries: each body's is moved and deformed by the affine
/// map that fits the places of its particles best (metrics/carried_body.hpp).
///  Of a surface the pieces count for normals that face the other body within two cells. Of the piece of either body that
/// is nearest to the node the one counts whose normal is nearer to the node's: at a corner on a face that is the face's.
/// `normal_error` weighs nodes by their force in the last step, and `largest_normal_error` is over those with at least a
/// hundredth of the largest force; forces that rounding may give in a step of dt, s, count as none.
///  `misfit` says how well the surfaces are known: the root mean square distance of a body's particles from where the map
/// takes them, the larger one of the pair.
///  `gap` is that of the nearest places of convex bodies. Where one lies inside the other it is the depth of the deepest of
/// pieces a quarter of a cell long, in metres of the other body as it began, and 0 where none of their middles is inside.
std::vector<PairSurfaces> pair_surfaces(Views& views, const std::vector<ContactNode>& nodes, double dt);

}  // namespace mpm
