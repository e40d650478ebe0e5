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
/// (see_edges), and the area is that of its own surface along the normal (contact_area); `around` is the length
/// of the node's ring in axisymmetric scenes, m, else 1.
MPM_HD ContactGeometry rigid_contact_geometry(const ContactFieldNode& a, const EdgeTable& edge,
                                              const RigidSurface& surface, double around, double cell_size,
                                              int dimension) {
  ContactGeometry result;
  double area = 0;
  for (int i = 0; i < dimension; ++i) {
    result.normal[i] = surface.normal[i];
    area += a.volume_gradient[i] * surface.normal[i];
  }
  result.separation = surface.distance - edge.edge(mean_position(a, surface.normal, cell_size, dimension)) * cell_size;
  result.area = max(area, 0.0) * around;
  result.valid = true;
  return result;
}

}  // namespace mpm
