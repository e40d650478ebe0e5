#pragma once
// How far the normals of contact are from those of the surfaces that meet, where these are known.

#include <vector>

#include "metrics/probes.hpp"

namespace mpm {

/// Of one pair of velocity fields. Angles are NaN where no node has a force, or the bodies do not face each
/// other any more; all numbers are where a body has no affine motion of its own, as a single row of particles.
struct PairNormalError {
  double mean = 0, largest = 0;  ///< degrees
  double misfit = 0;             ///< m
};

/// For each pair (pair_index) the angle between the normal of contact at a node and that of the surfaces that meet there,
/// which are known from the geometries: each body's is moved and deformed by the affine map that fits the places of its
/// particles best, by their masses, and of its surface the pieces count that face the other body within two cells. Of the
/// piece of either body that is nearest to the node the one counts whose normal is nearer to the node's: at a corner on a
/// face that is the face's. `mean` weighs nodes by their force in the last step, and `largest` is over those with at least
/// a hundredth of the largest force; forces that rounding may give in a step of dt, s, count as none. `misfit` says how well the surfaces are known: the root mean square distance of a
/// body's particles from where the map takes them, the larger one of the pair.
std::vector<PairNormalError> pair_normal_errors(Views& views, const std::vector<ContactNode>& nodes, double dt);

}  // namespace mpm
