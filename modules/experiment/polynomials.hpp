#pragma once
// The polynomials of a transfer beyond the affine ones (kernel/polynomial_basis.hpp), as a scene has them.

#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// Highest power along an axis that the transfer asks for; 0: none.
int basis_order_of(const Component& transfer);
/// The same, as far as the nodes of a shape along an axis bear it.
int basis_order_of(const Component& transfer, const Plugin& shape);

/// Names of their coefficients as fields of particles, in the order in which a particle keeps them: "polynomial_" and the
/// power along each axis, "polynomial_11" for d_x d_y. Each is a vector, m/s. Components must have their plugins.
std::vector<std::string> polynomial_names(const Experiment& experiment);

}  // namespace mpm
