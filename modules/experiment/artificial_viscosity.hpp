#pragma once
// What an experiment says of artificial viscosity: a section of a material, whatever its law.

#include <optional>

#include "experiment/experiment.hpp"
#include "experiment/parameter.hpp"

namespace mpm {

/// The key "artificial_viscosity" of a material.
ParameterSpec artificial_viscosity_parameter();

/// What the fields of a material with `component` say of artificial viscosity; nothing without that key. `resolved` is the
/// material's.
std::optional<ArtificialViscositySpecification> read_artificial_viscosity(const Fields& material,
                                                                          const Component& component,
                                                                          ReadContext& context, OrderedJson& resolved);

}  // namespace mpm
