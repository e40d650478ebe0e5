#pragma once
// Particles that go over to another body, and so to its material: which ones, and what they are there. A particle
// keeps its place, motion, mass, volume and temperature. Its new material is at rest but for the volume ratio that the
// particle has: shape and history of the old one are forgotten.

#include <vector>

#include "metrics/body_sums.hpp"
#include "simulation/particle_state.hpp"

namespace mpm {

/// Throws InputError where particles of a body do not have the quantity that their change asks for.
void refuse_unknown_quantities(const Experiment& experiment);

/// Whether any body looks for particles that go over after so many steps.
bool changes_of_material_are_due(const Experiment& experiment, long steps);

/// A particle on its way from one body to another.
struct Changed {
  int from = 0, to = 0;
  std::size_t particle = 0;  ///< its number in the body that it comes from
};
/// The particles that go over after so many steps, but those that are `gone`, body by body.
std::vector<Changed> changing_particles(const Experiment& experiment, const Backend& backend, long steps,
                                        const std::vector<std::vector<bool>>& gone);

/// What some particles of one body are in another one.
class MaterialChange {
 public:
  /// `view` is of the body that they come from, `of_start` of that which they go over to.
  MaterialChange(const Experiment& experiment, const BodyView& view, const ParticleState& state,
                 const std::vector<Changed>& particles, const SeededBody& of_start);

  std::size_t to() const { return to_; }
  /// Their seeds in the other body.
  const Newcomers& newcomers() const { return newcomers_; }
  /// Writes what they keep, and their new material, into the other body's particles from number `first` on.
  void put(ParticleState& state, std::size_t first) const;

 private:
  void take_seeds(const ParticleState& state);
  void rest_at_volume();

  const Experiment& experiment_;
  const std::vector<Changed> particles_;
  const std::size_t from_, to_;
  std::vector<double> volume_ratio_, temperature_, melted_;
  Newcomers newcomers_;
  std::vector<std::vector<double>> kept_;  ///< of each saved field of the other body; empty where seeding says it
};

}  // namespace mpm
