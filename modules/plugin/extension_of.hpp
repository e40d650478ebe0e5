#pragma once
// The extensions of extensions.h, asked for by the type of their table: extension_of<mpm_costs>(plugin).

#include <span>

#include "plugin/extensions.h"
#include "plugin/registry.hpp"

namespace mpm {

/// Id, version and kind (0: any) of the extension whose table a struct is.
struct KnownExtension {
  const char* id;
  std::uint32_t version;
  std::uint32_t kind;
};
template <class Table>
inline constexpr KnownExtension extension_info{};
#define MPM_KNOWN_EXTENSION(table, NAME, kind) \
  template <>                                  \
  inline constexpr KnownExtension extension_info<table>{NAME##_ID, NAME##_VERSION, kind};
MPM_KNOWN_EXTENSION(mpm_costs, MPM_COSTS, 0)
MPM_KNOWN_EXTENSION(mpm_refusals, MPM_REFUSAL, 0)
MPM_KNOWN_EXTENSION(mpm_shape_boxes, MPM_SHAPE_BOXES, MPM_SHAPE)
MPM_KNOWN_EXTENSION(mpm_shape_courant_limit, MPM_SHAPE_COURANT_LIMIT, MPM_SHAPE)
MPM_KNOWN_EXTENSION(mpm_transfer_polynomials, MPM_TRANSFER_POLYNOMIALS, MPM_TRANSFER)
MPM_KNOWN_EXTENSION(mpm_filter_step_limit, MPM_FILTER_STEP_LIMIT, MPM_FILTER)
MPM_KNOWN_EXTENSION(mpm_contact_step_limit, MPM_CONTACT_STEP_LIMIT, MPM_CONTACT)
MPM_KNOWN_EXTENSION(mpm_material_trial, MPM_MATERIAL_TRIAL, MPM_MATERIAL)
MPM_KNOWN_EXTENSION(mpm_material_tangent, MPM_MATERIAL_TANGENT, MPM_MATERIAL)
MPM_KNOWN_EXTENSION(mpm_material_projection, MPM_MATERIAL_PROJECTION, MPM_MATERIAL)
MPM_KNOWN_EXTENSION(mpm_material_makes_energy, MPM_MATERIAL_MAKES_ENERGY, MPM_MATERIAL)
MPM_KNOWN_EXTENSION(mpm_material_dissipation, MPM_MATERIAL_DISSIPATION, MPM_MATERIAL)
MPM_KNOWN_EXTENSION(mpm_material_clamps, MPM_MATERIAL_CLAMPS, MPM_MATERIAL)
MPM_KNOWN_EXTENSION(mpm_material_temperature, MPM_MATERIAL_TEMPERATURE, MPM_MATERIAL)
MPM_KNOWN_EXTENSION(mpm_material_cell_size, MPM_MATERIAL_CELL_SIZE, MPM_MATERIAL)
#undef MPM_KNOWN_EXTENSION

/// All extensions that this program knows, in the order of extensions.h.
std::span<const KnownExtension> known_extensions();

/// The table that the plugin has of an extension, or null.
template <class Table>
const Table* extension_of(const Plugin& plugin) {
  return static_cast<const Table*>(plugin.extension(extension_info<Table>.id));
}

}  // namespace mpm
