// The plugin boundary is frozen as version 1: every struct's fields, their places, sizes and types, and every number of
// an enumeration are those of the record. A field may be added at the end with a new MPM_ABI_REVISION: then the record
// is written anew (MPM_RECORD_ABI=1) and reviewed. Anything else is a new version.

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <typeinfo>

#include "plugin/abi.h"
#include "support/catch.hpp"

namespace {

#define FIELD(structure, field)                                                                                  \
  out << "  " #field " at " << offsetof(structure, field) << ", " << sizeof(structure::field) << " bytes, type " \
      << typeid(decltype(structure::field)).name() << "\n"
#define NUMBER(name) out << "  " #name " = " << static_cast<long>(name) << "\n"

// The sizes of pointers are meant: they are fields.
// NOLINTBEGIN(bugprone-sizeof-expression)
std::string boundary() {
  std::ostringstream out;
  out << "constants\n";
  NUMBER(MPM_ABI_VERSION);
  NUMBER(MPM_ABI_REVISION);
  NUMBER(MPM_BATCH);
  NUMBER(MPM_LANES);
  NUMBER(MPM_BOX_WIDTH);
  NUMBER(MPM_SHAPE);
  NUMBER(MPM_TRANSFER);
  NUMBER(MPM_FILTER);
  NUMBER(MPM_CONTACT);
  NUMBER(MPM_MATERIAL);
  NUMBER(MPM_LANES_FLOAT);
  NUMBER(MPM_LANES_DOUBLE);
  NUMBER(MPM_SCALAR_DOUBLE);
  NUMBER(MPM_PRECISIONS);
  NUMBER(MPM_NUMBER);
  NUMBER(MPM_INTEGER);
  NUMBER(MPM_BOOLEAN);
  NUMBER(MPM_CHOICE);
  NUMBER(MPM_REQUIRED);
  NUMBER(MPM_ABOVE_MINIMUM);
  NUMBER(MPM_BELOW_MAXIMUM);
  NUMBER(MPM_STATE_SCALAR);
  NUMBER(MPM_STATE_VECTOR);
  NUMBER(MPM_STATE_MATRIX);
  NUMBER(MPM_STATE_SYMMETRIC);
  NUMBER(MPM_STATE_DEFORMATION);
  NUMBER(MPM_STATE_PLANE_DEFORMATION);
  NUMBER(MPM_INITIAL_ZERO);
  NUMBER(MPM_INITIAL_ONE);
  NUMBER(MPM_INITIAL_IDENTITY);
  NUMBER(MPM_TENSOR_PRODUCT);
  NUMBER(MPM_NODE_LIST);
  NUMBER(MPM_MOMENT_CONSTANT);
  NUMBER(MPM_MOMENT_IS_GRADIENT);
  NUMBER(MPM_MOMENT_PER_PARTICLE);
  NUMBER(MPM_SCATTERS_AFFINE);
  NUMBER(MPM_GATHERS_INCREMENT);
  NUMBER(MPM_GATHERS_AFFINE);
  NUMBER(MPM_STRESS_BY_AFFINE);
  NUMBER(MPM_STRAIN_BY_AFFINE);
  NUMBER(MPM_AFFINE_CARRIES_ENERGY);
  NUMBER(MPM_GATHERS_GRADIENT);
  NUMBER(MPM_READS_SECOND_MOMENT);
  NUMBER(MPM_KEEPS_SPIN_ONLY);
  NUMBER(MPM_STARTS_WITH_GRADIENT);
  NUMBER(MPM_REPLACES_MOTION);
  NUMBER(MPM_FILTERS_BEFORE_FORCES);
  NUMBER(MPM_BYPASSES_DETECTION);
  NUMBER(MPM_PULLS);
  NUMBER(MPM_APART);
  NUMBER(MPM_STICKS);
  NUMBER(MPM_SLIPS);
  NUMBER(MPM_HYPERELASTIC);
  NUMBER(MPM_OBJECTIVE);
  NUMBER(MPM_DISSIPATES);
  NUMBER(MPM_STRAINS_AROUND_AXIS);
  NUMBER(MPM_2D);
  NUMBER(MPM_3D);
  NUMBER(MPM_NEEDS_HALF_SIZE);
  NUMBER(MPM_NEEDS_DOMAIN);
  out << "mpm_parameter, " << sizeof(mpm_parameter) << " bytes\n";
  FIELD(mpm_parameter, name);
  FIELD(mpm_parameter, unit);
  FIELD(mpm_parameter, doc);
  FIELD(mpm_parameter, choices);
  FIELD(mpm_parameter, type);
  FIELD(mpm_parameter, flags);
  FIELD(mpm_parameter, offset);
  FIELD(mpm_parameter, reserved);
  FIELD(mpm_parameter, default_value);
  FIELD(mpm_parameter, minimum);
  FIELD(mpm_parameter, maximum);
  out << "mpm_state, " << sizeof(mpm_state) << " bytes\n";
  FIELD(mpm_state, name);
  FIELD(mpm_state, unit);
  FIELD(mpm_state, doc);
  FIELD(mpm_state, shape);
  FIELD(mpm_state, initial);
  out << "mpm_shape_batch, " << sizeof(mpm_shape_batch) << " bytes\n";
  FIELD(mpm_shape_batch, count);
  FIELD(mpm_shape_batch, stride);
  FIELD(mpm_shape_batch, dimension);
  FIELD(mpm_shape_batch, reserved);
  FIELD(mpm_shape_batch, position);
  FIELD(mpm_shape_batch, half_size);
  FIELD(mpm_shape_batch, domain);
  FIELD(mpm_shape_batch, base);
  FIELD(mpm_shape_batch, offset);
  FIELD(mpm_shape_batch, weight);
  FIELD(mpm_shape_batch, gradient);
  FIELD(mpm_shape_batch, second_moment);
  out << "mpm_list_batch, " << sizeof(mpm_list_batch) << " bytes\n";
  FIELD(mpm_list_batch, count);
  FIELD(mpm_list_batch, stride);
  FIELD(mpm_list_batch, dimension);
  FIELD(mpm_list_batch, capacity);
  FIELD(mpm_list_batch, position);
  FIELD(mpm_list_batch, half_size);
  FIELD(mpm_list_batch, domain);
  FIELD(mpm_list_batch, node_count);
  FIELD(mpm_list_batch, node);
  FIELD(mpm_list_batch, weight);
  FIELD(mpm_list_batch, gradient);
  FIELD(mpm_list_batch, second_moment);
  FIELD(mpm_list_batch, samples);
  out << "mpm_box_batch, " << sizeof(mpm_box_batch) << " bytes\n";
  FIELD(mpm_box_batch, count);
  FIELD(mpm_box_batch, stride);
  FIELD(mpm_box_batch, dimension);
  FIELD(mpm_box_batch, reserved);
  FIELD(mpm_box_batch, position);
  FIELD(mpm_box_batch, half_size);
  FIELD(mpm_box_batch, domain);
  FIELD(mpm_box_batch, base);
  FIELD(mpm_box_batch, extent);
  FIELD(mpm_box_batch, offset);
  FIELD(mpm_box_batch, weight);
  FIELD(mpm_box_batch, gradient);
  FIELD(mpm_box_batch, second_moment);
  out << "mpm_shape, " << sizeof(mpm_shape) << " bytes\n";
  FIELD(mpm_shape, form);
  FIELD(mpm_shape, width);
  FIELD(mpm_shape, second_moment_kind);
  FIELD(mpm_shape, reserved);
  FIELD(mpm_shape, second_moment);
  FIELD(mpm_shape, evaluate);
  FIELD(mpm_shape, capacity);
  FIELD(mpm_shape, reach);
  FIELD(mpm_shape, evaluate_list);
  FIELD(mpm_shape, evaluate_box);
  FIELD(mpm_shape, sample_points);
  out << "mpm_scatter_batch, " << sizeof(mpm_scatter_batch) << " bytes\n";
  FIELD(mpm_scatter_batch, count);
  FIELD(mpm_scatter_batch, stride);
  FIELD(mpm_scatter_batch, dimension);
  FIELD(mpm_scatter_batch, reserved);
  FIELD(mpm_scatter_batch, mass);
  FIELD(mpm_scatter_batch, velocity);
  FIELD(mpm_scatter_batch, state);
  FIELD(mpm_scatter_batch, b);
  FIELD(mpm_scatter_batch, A);
  out << "mpm_gather_batch, " << sizeof(mpm_gather_batch) << " bytes\n";
  FIELD(mpm_gather_batch, count);
  FIELD(mpm_gather_batch, stride);
  FIELD(mpm_gather_batch, dimension);
  FIELD(mpm_gather_batch, reserved);
  FIELD(mpm_gather_batch, dt);
  FIELD(mpm_gather_batch, velocity);
  FIELD(mpm_gather_batch, velocity_increment);
  FIELD(mpm_gather_batch, affine);
  FIELD(mpm_gather_batch, velocity_gradient);
  FIELD(mpm_gather_batch, particle_velocity);
  FIELD(mpm_gather_batch, state);
  FIELD(mpm_gather_batch, advection_velocity);
  FIELD(mpm_gather_batch, second_moment);
  out << "mpm_transfer, " << sizeof(mpm_transfer) << " bytes\n";
  FIELD(mpm_transfer, traits);
  FIELD(mpm_transfer, reserved);
  FIELD(mpm_transfer, scatter);
  FIELD(mpm_transfer, gather);
  FIELD(mpm_transfer, basis_order);
  out << "mpm_filter_batch, " << sizeof(mpm_filter_batch) << " bytes\n";
  FIELD(mpm_filter_batch, count);
  FIELD(mpm_filter_batch, stride);
  FIELD(mpm_filter_batch, dimension);
  FIELD(mpm_filter_batch, iteration);
  FIELD(mpm_filter_batch, projected);
  FIELD(mpm_filter_batch, increment);
  FIELD(mpm_filter_batch, velocity);
  out << "mpm_filter, " << sizeof(mpm_filter) << " bytes\n";
  FIELD(mpm_filter, traits);
  FIELD(mpm_filter, reserved);
  FIELD(mpm_filter, iterations);
  FIELD(mpm_filter, update);
  out << "mpm_contact_batch, " << sizeof(mpm_contact_batch) << " bytes\n";
  FIELD(mpm_contact_batch, count);
  FIELD(mpm_contact_batch, stride);
  FIELD(mpm_contact_batch, dimension);
  FIELD(mpm_contact_batch, reserved);
  FIELD(mpm_contact_batch, dt);
  FIELD(mpm_contact_batch, mass_a);
  FIELD(mpm_contact_batch, mass_b);
  FIELD(mpm_contact_batch, momentum_a);
  FIELD(mpm_contact_batch, momentum_b);
  FIELD(mpm_contact_batch, normal);
  FIELD(mpm_contact_batch, separation);
  FIELD(mpm_contact_batch, area);
  FIELD(mpm_contact_batch, impulse);
  FIELD(mpm_contact_batch, dissipated);
  FIELD(mpm_contact_batch, status);
  out << "mpm_contact, " << sizeof(mpm_contact) << " bytes\n";
  FIELD(mpm_contact, traits);
  FIELD(mpm_contact, reserved);
  FIELD(mpm_contact, apply);
  out << "mpm_material_batch, " << sizeof(mpm_material_batch) << " bytes\n";
  FIELD(mpm_material_batch, count);
  FIELD(mpm_material_batch, stride);
  FIELD(mpm_material_batch, dimension);
  FIELD(mpm_material_batch, reserved);
  FIELD(mpm_material_batch, dt);
  FIELD(mpm_material_batch, velocity_gradient);
  FIELD(mpm_material_batch, state);
  FIELD(mpm_material_batch, kirchhoff_stress);
  FIELD(mpm_material_batch, stored_energy);
  FIELD(mpm_material_batch, dissipated_energy);
  FIELD(mpm_material_batch, wave_speed);
  FIELD(mpm_material_batch, volume_ratio);
  FIELD(mpm_material_batch, velocity_gradient_zz);
  out << "mpm_material, " << sizeof(mpm_material) << " bytes\n";
  FIELD(mpm_material, traits);
  FIELD(mpm_material, reserved);
  FIELD(mpm_material, update);
  out << "mpm_descriptor, " << sizeof(mpm_descriptor) << " bytes\n";
  FIELD(mpm_descriptor, id);
  FIELD(mpm_descriptor, version);
  FIELD(mpm_descriptor, summary);
  FIELD(mpm_descriptor, citation);
  FIELD(mpm_descriptor, manual);
  FIELD(mpm_descriptor, kind);
  FIELD(mpm_descriptor, dimensions);
  FIELD(mpm_descriptor, precisions);
  FIELD(mpm_descriptor, needs);
  FIELD(mpm_descriptor, parameters);
  FIELD(mpm_descriptor, parameter_count);
  FIELD(mpm_descriptor, parameter_bytes);
  FIELD(mpm_descriptor, state);
  FIELD(mpm_descriptor, state_count);
  FIELD(mpm_descriptor, kind_table_size);
  FIELD(mpm_descriptor, kind_table);
  FIELD(mpm_descriptor, functor_name);
  FIELD(mpm_descriptor, source);
  out << "mpm_plugin_library, " << sizeof(mpm_plugin_library) << " bytes\n";
  FIELD(mpm_plugin_library, abi_version);
  FIELD(mpm_plugin_library, struct_size);
  FIELD(mpm_plugin_library, abi_revision);
  FIELD(mpm_plugin_library, descriptor_size);
  FIELD(mpm_plugin_library, parameter_size);
  FIELD(mpm_plugin_library, state_size);
  FIELD(mpm_plugin_library, descriptor_count);
  FIELD(mpm_plugin_library, reserved);
  FIELD(mpm_plugin_library, descriptors);
  return out.str();
}
// NOLINTEND(bugprone-sizeof-expression)

}  // namespace

TEST_CASE("the plugin boundary is that of the record of its version", "[abi]") {
  const std::string record =
      std::string(MPM_SOURCE_DIR) + "/tests/unit/fixtures/abi_version_" + std::to_string(MPM_ABI_VERSION) + ".txt";
  if (std::getenv("MPM_RECORD_ABI")) std::ofstream(record) << boundary();
  std::stringstream recorded;
  recorded << std::ifstream(record).rdbuf();
  INFO("A changed boundary breaks plugins that exist: see docs/design/plugin_boundary.md, \"Versions\"");
  CHECK(recorded.str() == boundary());
}
