#pragma once
// Fields of all particles of a run at one moment, as files hold them.

#include <array>
#include <string>
#include <vector>

#include "experiment/particle_output.hpp"
#include "simulation/backend.hpp"

namespace mpm {

/// One field of all particles, body by body. Vectors have three components, tensors nine in rows, also in 2-D: what
/// lies across the plane is there too. NaN where the particles of a body have no such field.
struct ParticleValues {
  ParticleField field;
  std::vector<double> values;  ///< [particle][component]
};

/// The fields of these names, which particle_fields() of the experiment holds. `states` has one entry a body.
std::vector<ParticleValues> particle_values(const Experiment& experiment, const std::vector<BodyState>& states,
                                            const std::vector<std::string>& names);

/// Positions of all particles, m, three numbers each.
std::vector<double> particle_positions(const Experiment& experiment, const std::vector<BodyState>& states);

/// The corners of all particles' domains, m, three numbers a corner: four a particle in 2-D and eight in 3-D, in VTK's
/// order of a quadrilateral and a hexahedron. A domain is what its shape carries, or the undeformed box that the
/// material's F deforms, or that box where nobody keeps F.
std::vector<double> particle_domains(const Experiment& experiment, const std::vector<BodyState>& states);

}  // namespace mpm
