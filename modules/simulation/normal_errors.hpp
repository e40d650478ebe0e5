#pragma once
// How far a contact normal turns from the true one: at the nodes along a flat face, at the end of a block or along a disc's
// rim, in 2-D, between two bodies of particles.

#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// Where two bodies touch. A disc fills a hole in the other; a block ends on a half plane.
enum class TouchingSurface { face, disc, end_of_block };

/// Two bodies that touch. Lengths are in cells.
struct TouchingBodies {
  TouchingSurface surface = TouchingSurface::face;
  int particles_per_cell_axis = 2;
  double density_ratio = 1;  ///< of the second body, which has the hole or is the block, to the first
  double radius = 8;         ///< of the disc
  /// Each body lies on a square lattice of its own, turned and shifted against the grid otherwise at each place, as
  /// bodies do that have moved; else both lie on the grid's.
  bool turned = true;
};

/// The errors at the nodes where the surface has about one angle against the grid.
struct NormalErrors {
  double angle = 0;    ///< degrees, 0 to 45: between the surface's normal and the nearest axis of the grid
  double rms = 0;      ///< degrees, of the angle between the normal that is found and the true one, weighted as below
  double weight = 0;   ///< sum over the nodes
  double largest = 0;  ///< degrees
  long nodes = 0;      ///< with a normal; twice where each body has its own
  long without = 0;    ///< where both bodies have mass and no normal is found
};

/// The errors of a normal, over all nodes that contact looks at (near a block's end those less than two cells from it along
/// the face). Of flat faces one entry for each of `angles`, degrees, over `places` of the face along its normal within a
/// cell; of a disc one for each angle as the middle of its nodes' angles, over as many places of the centre. At a node of
/// the disc the true normal is the direction from the centre to it. A node weighs V_a V_b / (V_a + V_b), as what contact
/// gives there does between bodies of one density. Throws std::invalid_argument for a shape that lists
/// its nodes, for numbers of particles or places below 1, and for a ratio or a radius that is not above 0.
std::vector<NormalErrors> normal_errors(const Component& normal, const Component& shape, const TouchingBodies& bodies,
                                        const std::vector<double>& angles, int places = 16);

}  // namespace mpm
