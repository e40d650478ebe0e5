#pragma once

#include <array>

#include "simulation/backend.hpp"

namespace mpm {

/// F where the particle's material keeps it, row-major in the plane or in space; null else.
const double* deformation_gradient(const BodyState& state, std::size_t p, int dimension);

/// The semi-sides of a particle's domain, m: [3 i + a] is component i of the a-th. The domain is what the shape carries, or the
/// undeformed box that F deforms, or that box where the material keeps no F. Of corners they are the mean ones.
std::array<double, 9> semi_sides(const Experiment& experiment, int body, const BodyState& state, std::size_t p);

}  // namespace mpm
