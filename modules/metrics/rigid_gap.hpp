#pragma once

#include <cstddef>

namespace mpm {

class Views;
struct RigidState;

/// The smallest distance between the surface of a rigid body, whose geometry is exact, and that of a particle of any body, m:
/// negative where they overlap. A particle extends along the normal of the surface as the ellipsoid of its domain does
/// (metrics/particle_domain.hpp). Not a number without particles.
double rigid_gap(Views& views, std::size_t rigid_body, const RigidState& state);

}  // namespace mpm
