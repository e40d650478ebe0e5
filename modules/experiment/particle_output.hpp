#pragma once
// The section `output/particles`: which data of the particles are written, when and how.

#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/parameter.hpp"

namespace mpm {

/// A field that the particles of a scene have, or that follows from what they have.
struct ParticleField {
  /// The numbers a particle in files: a tensor has all nine in rows, also in 2-D.
  enum class Shape { scalar = 1, vector = 3, tensor = 9 };

  std::string name, unit;
  Shape shape = Shape::scalar;
};

/// All fields that a scene offers, in the order of the documentation: what every scene has, temperature, then state of
/// the materials and of the transfer, each once. Components must have their plugins.
std::vector<ParticleField> particle_fields(const Experiment& experiment);

/// The key `particles` of the section `output`.
ParameterSpec particle_output_parameter();
/// Schemas of those values of the section that are read by code of their own, by definition.
OrderedJson particle_output_schemas();

/// Reads the section. Unknown fields, those that the scene does not hold and keys that mean nothing beside the others
/// become problems of the context.
ParticleOutput read_particle_output(const Fields& fields, const Experiment& experiment, ReadContext& context,
                                    OrderedJson& resolved);

}  // namespace mpm
