#pragma once
// The geometry of material that meets a rigid body at a node, whose surface and normal are known. All backends use it.

#include "operators/contact_geometry.hpp"

namespace mpm {

/// A node that lies outside a rigid body by more than this, in cells, is left free: of so far a surface its material says
/// little but rounding, and beside an infinite mass a node that is held at all is held as a whole.
inline constexpr double rigid_reach = 1;

/// What a node sees of a rigid body: how far its surface is along the normal, m, negative inside it; and the unit normal
/// into it.
struct RigidSurface {
  double distance;
  double normal[3];
};

/// How the material of a velocity field meets a rigid body at a node. Its own edge is found as beside another body
/// (separation_of_edges). The body fills what is left of the node's `cell`, m^3 (m^2 in 2-D), which gives the area (Nairn
/// 2013, eq. 26).
MPM_HD ContactGeometry rigid_contact_geometry(const ContactFieldNode& a, const EdgeTable& edge,
                                              const RigidSurface& surface, double cell, double cell_size,
                                              int dimension) {
  ContactGeometry result;
  double position = 0;
  for (int i = 0; i < dimension; ++i) {
    result.normal[i] = surface.normal[i];
    position += a.mass_position[i] * surface.normal[i];
  }
  result.separation = surface.distance - edge.edge(position / (a.mass * cell_size)) * cell_size;
  result.area = sqrt(2 * cell * min(a.volume, max(cell - a.volume, 0.0))) / cell_size;
  result.valid = true;
  return result;
}

}  // namespace mpm
