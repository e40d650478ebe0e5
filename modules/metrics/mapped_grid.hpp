#pragma once
// Mass and velocity of the nodes as the particles stand, mapped once on the host.

#include <array>
#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

/// Values of the nodes of the domain, from its lower to its upper corner, x fastest.
struct MappedGrid {
  std::array<int, 3> nodes{1, 1, 1};  ///< along each axis
  struct Field {
    std::vector<double> mass;      ///< kg
    std::vector<double> velocity;  ///< m/s, three numbers a node; zero where there is no mass
  };
  std::vector<Field> fields;  ///< one a velocity field
};

/// Adds each particle's mass and momentum to the nodes by the weights of the scene's shape, m w and m w v, and divides;
/// the affine velocity of a transfer is left out. What lies beyond a wall is folded into its mirror image as in a step,
/// periodic images are summed, and on a wall the components that it holds are those of the wall; contact, forces, boxes
/// of conditions and filters are left out. `time` (s) is that of moving walls.
MappedGrid mapped_grid(const Experiment& experiment, const std::vector<BodyState>& states, double time);

}  // namespace mpm
