#pragma once
// Kinetic energy of the polynomials beyond affine that a transfer's particles carry.

#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

/// One number a particle, J per kg: sum |c|^2 sum w P^2 / 2, with the weights of the shape at its position. Empty when
/// the plan has no such polynomials.
std::vector<double> polynomial_energy(const Experiment& experiment, const Plan& plan, int body, const BodyState& state);

}  // namespace mpm
