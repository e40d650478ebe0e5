#pragma once
// Values of single particles computed from a body's state: what the energies sum and what frames and VTK files show.

#include <span>
#include <string>
#include <vector>

#include "experiment/clamps.hpp"
#include "simulation/backend.hpp"

namespace mpm {

/// What a material says of each particle of a body, from its state and its phase alone.
struct MaterialQuantities {
  std::vector<double> stress;         ///< Kirchhoff, particle-major, xx yy zz xy | xx yy zz yz xz xy, Pa
  std::vector<double> stored_energy;  ///< J/m^3 of initial volume
  std::vector<double> wave_speed;     ///< m/s
  std::vector<double> volume_ratio;   ///< J
};
MaterialQuantities material_quantities(const Experiment& experiment, int body, const BodyState& state);

/// Looks for clamps of the body's material among the particles that have melted, or among those that have not.
void look_for_clamps(const Experiment& experiment, int body, const BodyState& state, bool melted, double time,
                     ClampWatch& watch);

/// The von Mises stress of a Kirchhoff stress in the order of MaterialQuantities.
double von_mises(const double* tau, int dimension);

/// Whether a particle has the melted phase's parameters.
bool has_melted(const Experiment& experiment, int body, const BodyState& state, std::size_t p);

/// A quantity that colours particles: name, what it is called on the bar, unit.
struct QuantityDescription {
  std::string name, label, unit;
};
/// Quantities that every scene offers. Components of position, displacement, velocity and Cauchy stress (stress_xy), and the
/// state of its materials, transfer and law of contact, add to them: scalars by name (equivalent_plastic_strain), others by
/// component (deformation_gradient_xy).
std::span<const QuantityDescription> common_quantities();
/// Names valid as output/colour_by for any of the plugins of `registry`.
std::vector<std::string> quantity_names(const Registry& registry);
/// Names that mean something for the particles of a body.
std::vector<std::string> quantity_names(const Experiment& experiment, int body);
QuantityDescription describe_quantity(const Experiment& experiment, const std::string& name);

/// The quantity of every particle of a body; zero for bodies whose material has no such state field.
std::vector<double> quantity(const Experiment& experiment, int body, const BodyState& state, const std::string& name);

}  // namespace mpm
