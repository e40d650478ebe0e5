#pragma once
// What an experiment says of heat: materials that conduct and store it, temperatures at the start, at walls, in boxes.

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/parameter.hpp"

namespace mpm {

/// The key "thermal" of a material, whose plugin's parameters may change where it melts.
ParameterSpec thermal_parameter(const Plugin& plugin);
/// The key "temperature" of a body.
ParameterSpec body_temperature();
/// What a wall may do with heat: "temperature", "heat_flux", "convection".
std::vector<ParameterSpec> wall_heat_parameters();
/// What the nodes of a box may do with heat: "temperature", "heating".
std::vector<ParameterSpec> box_heat_parameters();

/// What the fields of a material with `component` say of heat; nothing without "thermal". `resolved` is the material's.
std::optional<Thermal> read_thermal(const Fields& material, const Component& component, ReadContext& context,
                                    OrderedJson& resolved);

/// What the fields of a wall or box say of heat, at most one of their keys. `resolved` is the wall's or box's.
ThermalCondition read_thermal_condition(const Fields& fields, ReadContext& context, OrderedJson& resolved);

/// Checks that every body has a temperature and a material that conducts, or that nothing in the scene speaks of heat.
void check_temperature(const Node& root, const Experiment& experiment, ReadContext& context);

/// Why a transfer does not carry temperature as it carries velocity, with what to choose instead; nothing when it does.
/// `basis_order` is the highest power of the polynomials that its parameters ask for (mpm_transfer::basis_order).
std::optional<std::string> refusal_of_temperature(const Plugin& transfer, int basis_order);

/// Why the shape cannot be had with a transfer that carries gradients of the temperature; nothing where it can. With a
/// linear shape the gradient is that between two nodes, of which one may hold almost nothing at the edge of a moving body.
std::optional<std::string> refusal_of_gradients(const Experiment& experiment);

}  // namespace mpm
