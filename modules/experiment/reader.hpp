#pragma once
// The reader behind read_experiment: one an experiment, its parts spread over read_*.cpp.

#include <string>
#include <vector>

#include "experiment/geometry.hpp"
#include "experiment/parameter.hpp"
#include "experiment/read.hpp"
#include "experiment/sections.hpp"
#include "plugin/extensions.h"

namespace mpm {

class ExperimentReader {
 public:
  ExperimentReader(Node root, const std::filesystem::path& file, const ComponentLookup& components,
                   const ReadOptions& options);

  /// Reads the experiment. Throws InputError.
  Experiment read();

 private:
  struct Chosen {
    Component component;
    std::optional<Fields> fields;
    OrderedJson resolved;
  };

  // read.cpp
  void read_header(const Fields& fields);
  void read_solver(const Node* node);
  void read_output(const Node* node);
  void read_compare(const Node* node);
  void read_limits(const Node* node);
  OrderedJson read_exact(const Node& node);

  // read_records.cpp
  void read_normal_error(const Fields& fields);
  void read_contact_nodes(const Fields& fields);
  void read_records(const Fields& fields);
  OrderedJson read_recorded_bodies(const Node& node);
  OrderedJson read_group(const Node& node);
  OrderedJson read_probe(const Node& node);
  void read_line(const Fields& fields, ProbeSpecification& probe, OrderedJson& resolved);
  void read_section(const Fields& fields, ProbeSpecification& probe, OrderedJson& resolved);
  void read_column_figures(const Node* node);
  void check_probe_inside(const Fields& fields, const ProbeSpecification& probe);
  /// Whether the text of a key is a name out of letters, digits and _, as headings and paths of results need; else a
  /// problem is recorded.
  bool check_word(const Fields& fields, const char* key);
  void check_record_name(const Fields& fields, bool is_taken, const char* what);
  /// The index of a body, or -1 with a problem recorded.
  int body_index(const Node& place, const std::string& name);
  int body_index(const Fields& fields);  ///< that of the key "body"

  // read_components.cpp
  Chosen read_component(const Node& node, mpm_kind kind);
  Chosen read_component(const Node& node, mpm_kind kind, const std::vector<Section>& kinds);
  void check_capability(const Plugin& plugin, mpm_kind kind, const Node& place);
  void read_filter_schedule(const Fields& fields);
  void read_components(const Fields& fields);
  std::optional<Component> read_part_of_contact(const Fields& contact, mpm_kind kind, const char* word);
  void check_contact(const Fields& fields);
  void read_materials(const Node* node);

  // read_grid.cpp
  void read_grid(const Node* node);
  bool read_domain(const Fields& fields);
  OrderedJson read_boundaries(const Node* node);
  OrderedJson read_face(const Node& node, FaceCondition& face);
  void check_periodic(const Fields& fields);
  void read_node_conditions(const Node* node);
  OrderedJson read_node_condition(const Node& node);

  // read_supports.cpp
  void read_gravity(const Fields& fields);
  void read_damping(const Node* node);
  void read_reactions(const Fields& fields);
  std::string name_of_box(const Fields& fields);
  void check_support_name(const std::string& name, const Node& place);
  void check_free_fall();
  void read_grips(const Node* node);
  OrderedJson read_grip(const Node& node);
  void refuse_nothing_held(const Fields& fields, const std::array<bool, 3>& held, const std::string& remedy);

  // read_rigid_bodies.cpp
  void read_rigid_bodies(const Node* node);
  OrderedJson read_rigid_body(const Node& node);
  void check_rigid_about_axis(const Fields& fields);

  // read_particle_changes.cpp
  void read_emitters(const Node* node);
  OrderedJson read_emitter(const Node& node);
  void place_emitter(const Fields& fields, Emitter& emitter);
  void read_sinks(const Node* node);
  OrderedJson read_sink(const Node& node);
  int changed_body(const Fields& fields);
  void read_becoming(const Fields& fields, BodySpecification& body, OrderedJson& resolved);
  void find_becoming_bodies();
  void check_becoming(std::size_t body);
  void check_particle_changes();
  void refuse_with_changes(int body, const std::string& name);
  bool may_start_empty(const std::string& body) const;

  // read_symmetry.cpp
  void check_axisymmetric();
  void check_axis();
  std::string gravity_along_axis() const;
  void check_frozen();

  // read_seeding.cpp
  OrderedJson read_seeding(const Node* node, BodySpecification& body);
  void read_points(const Fields& fields, BodySpecification& body, OrderedJson& resolved);
  void read_initial_state(const Fields& fields, BodySpecification& body, OrderedJson& resolved);

  // read_bodies.cpp
  void read_bodies(const Node* node);
  OrderedJson read_body(const Node& node);
  int material_index(const Fields& fields);
  void check_inside(const BodySpecification& body, const Node& place);
  bool holds_a_particle(const BodySpecification& body) const;
  void assign_fields(const Node& bodies);

  // read_loads.cpp
  void read_loads(const Node* node);
  OrderedJson read_load(const Node& node);
  bool find_loaded_body(const Fields& fields, Load& load);
  bool may_be_loaded_at_points(const Load& load, const Fields& fields);
  void read_spring(const Fields& fields, const Node& node, Load& load);
  void check_loaded_points(const Load& load, const Fields& fields);
  void check_loaded_surface(const Load& load, const Node& where);

  void problem(const Node& at, std::string message) { context_.problem(at, std::move(message)); }
  bool is_list(const Node& node, const char* what, bool may_be_empty);

  Node root_;
  const ComponentLookup& components_;
  const ReadOptions& options_;
  ReadContext context_;
  Experiment experiment_;
  OrderedJson resolved_;
  bool grid_good_ = false, capability_known_ = false;
  std::vector<std::string> becoming_;       ///< the body that each body's particles go over to, "" for none
  std::vector<std::string> field_choices_;  ///< what each body said, "" for nothing
};

/// Whether a text can name something in formulas, headings and paths: letters, digits and _, no digit first.
bool is_name(const std::string& text);

/// Reads the named numbers under "constants" into the context; returns them, null where there are none.
OrderedJson read_constants(const Node& root, ReadContext& context);

/// Reads one entry of compare/expect.
Expectation read_expectation(const Node& node, ReadContext& context, OrderedJson& resolved);

/// The plugin with the parameters that its fields hold.
Component component_of(const Plugin& plugin, const Fields& fields, const std::string& pointer);

/// Asks the plugin whether its parameters fit one another and the scene. What does not is a problem of the context, at
/// the key of that parameter (`component_node` where the file leaves it out), or at `cell_size`.
void refuse_parameters(const Component& component, const Fields& fields, mpm_refusal_case scene,
                       const Node& component_node, const Node& cell_size, ReadContext& context);

/// Reads a geometry and everything in it; null, with problems recorded, when it is not usable.
GeometryPointer read_geometry(const Node& node, ReadContext& context, OrderedJson& resolved);

}  // namespace mpm
