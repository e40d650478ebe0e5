#pragma once
// What the components of a scene declare their fields with.

#include "plan/plan.hpp"
#include "plan/step_builder.hpp"

namespace mpm {

/// The fields of a plan whose step is complete, as they are declared one after another.
class FieldList {
 public:
  FieldList(Plan& plan, const Experiment& experiment)
      : plan(plan), experiment(experiment), needs(backend_needs(experiment.backend)) {}

  /// What a state that a plugin declares begins as.
  static First first_of(const mpm_state& declared) {
    if (declared.initial == MPM_INITIAL_ZERO) return First::zero;
    if (declared.initial == MPM_INITIAL_ONE) return First::one;
    return declared.shape == MPM_STATE_SYMMETRIC ? First::symmetric_identity : First::identity;
  }
  static std::string named(const Component& component) { return StepBuilder::named(component); }
  /// The reason for what the backend keeps although nothing in the scene asks for it.
  std::string why_apart() const { return "/backend \"" + experiment.backend + "\" keeps all values apart"; }

  Field& of_particles(int body, const std::string& id, const std::string& unit, int components, First first,
                      const std::string& because);
  /// Nodes hold groups of four scalars, as many as a vector register's lane has; a scalar may stand in its vector's.
  Field& of_nodes(const std::string& id, const std::string& unit, int components, const std::string& because,
                  const std::string& beside = "");
  /// A field of nodes that particles are summed into.
  Field& summed(const std::string& id, const std::string& unit, int components, AtWall at_wall, Folded folded,
                const std::string& because, const std::string& beside = "");
  /// Lets the field take the memory of one that nobody reads any more, where the backend works in place.
  void in_place_of(const std::string& other, Field& field) const;

  Plan& plan;
  const Experiment& experiment;
  const BackendNeeds needs;

 private:
  std::uint64_t scalar_bytes() const { return experiment.precision == Precision::single ? 4 : 8; }
};

/// Declares what every component needs of particles, body by body, and of nodes.
void declare_particle_fields(FieldList& fields);
void declare_node_fields(FieldList& fields);

}  // namespace mpm
