#pragma once
// The tables of the experiment file: what the reader checks, the schema lists and `mpm describe` can print.

#include <vector>

#include "experiment/parameter.hpp"
#include "experiment/read.hpp"

namespace mpm {

constexpr int most_fields = 8;              ///< velocity fields an experiment may have
constexpr int most_grips = 4;               ///< grips an experiment may have: nodes keep two vectors for each
constexpr int most_cells_a_side = 1 << 20;  ///< beyond this no machine holds the grid

Section experiment_section(const ReadOptions& options);
Section grid_section();
/// The section of walls: "all" and the faces "x_min", "x_max", …; z faces only when `dimension` is not 2.
Section boundaries_section(int dimension);
std::vector<Section> face_condition_kinds();
std::vector<Section> node_condition_kinds();
std::vector<Section> geometry_kinds();
std::vector<Section> seeding_kinds();
Section body_section();
/// The loads, in the order of LoadType.
std::vector<Section> load_kinds();
/// The solvers that the program offers, each with its own keys.
std::vector<Section> solver_kinds(const ReadOptions& options);
/// Keys that every solver has, declared here for all of them.
ParameterSpec end_time_parameter();
ParameterSpec max_steps_parameter();
Section output_section(const ReadOptions& options);
Section damping_section();
Section grip_section();
/// A rigid body; in 2-D its angular velocity is a number, in 3-D a vector.
Section rigid_body_section(int dimension);
Section emitter_section();
Section sink_section();
Section compare_section();
Section limits_section();
Section expectation_section();
std::vector<Section> exact_kinds(const ReadOptions& options);

/// The limits that the fields of `limits_section` set, checked against each other.
Limits limits_of(const Fields& fields, ReadContext& context);

/// The contact normal and the detection of scenes that choose none.
inline constexpr const char* standard_normal = "average_volume_gradient";
inline constexpr const char* standard_detection = "approach_and_position";
/// The plugins of a kind as sections, with the keys the host itself reads beside them.
std::vector<Section> component_kinds(const ComponentLookup& components, mpm_kind kind);
/// The laws by which rigid bodies meet material: their normals and surfaces are known, nobody chooses how.
std::vector<Section> rigid_contact_kinds(const ComponentLookup& components);

}  // namespace mpm
