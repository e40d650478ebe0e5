#pragma once
// The reader behind read_experiment: one an experiment, its parts spread over read_*.cpp.

#include <string>
#include <vector>

#include "experiment/geometry.hpp"
#include "experiment/parameter.hpp"
#include "experiment/read.hpp"
#include "experiment/sections.hpp"

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
  void read_constants();
  void read_header(const Fields& fields);
  void read_solver(const Node* node);
  void read_output(const Node* node);
  void read_compare(const Node* node);
  void read_limits(const Node* node);
  OrderedJson read_exact(const Node& node);
  OrderedJson read_expectation(const Node& node);

  // read_components.cpp
  Chosen read_component(const Node& node, mpm_kind kind);
  void check_capability(const Plugin& plugin, mpm_kind kind, const Node& place);
  void read_filter_schedule(const Fields& fields);
  void read_components(const Fields& fields);
  void read_materials(const Node* node);

  // read_grid.cpp
  void read_grid(const Node* node);
  bool read_domain(const Fields& fields);
  OrderedJson read_boundaries(const Node* node);
  OrderedJson read_face(const Node& node, FaceCondition& face);
  void check_periodic(const Fields& fields);
  void read_node_conditions(const Node* node);
  OrderedJson read_node_condition(const Node& node);

  // read_symmetry.cpp
  void check_axisymmetric();
  void check_axis();
  void check_frozen();

  // read_bodies.cpp
  void read_bodies(const Node* node);
  OrderedJson read_body(const Node& node);
  int material_index(const Fields& fields);
  void check_inside(const BodySpecification& body, const Node& place);
  bool holds_a_particle(const BodySpecification& body) const;
  void assign_fields(const Node& bodies);

  void problem(const Node& at, std::string message) { context_.problem(at, std::move(message)); }
  bool is_list(const Node& node, const char* what, bool may_be_empty);

  Node root_;
  const ComponentLookup& components_;
  const ReadOptions& options_;
  ReadContext context_;
  Experiment experiment_;
  OrderedJson resolved_;
  bool grid_good_ = false, capability_known_ = false;
  std::vector<std::string> field_choices_;  ///< what each body said, "" for nothing
};

/// Reads a geometry and everything in it; null, with problems recorded, when it is not usable.
GeometryPointer read_geometry(const Node& node, ReadContext& context, OrderedJson& resolved);

}  // namespace mpm
