#pragma once
// What acts on a body from outside: on its surface, at points and lines, on all its mass, and springs to the ground.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "experiment/expression.hpp"
#include "experiment/geometry.hpp"

namespace mpm {

/// Forces from outside, by the row of the ledger that their work has. Each has a field of nodes of its own.
enum class ExternalForce { body_force, surface_load, point_load, spring, dashpot };
inline constexpr int external_force_count = 5;
/// The id of its field of nodes, N.
inline constexpr std::array<const char*, external_force_count> external_fields{"body_force", "surface_load",
                                                                               "point_load", "spring", "dashpot"};
inline constexpr std::array<ExternalForce, external_force_count> external_forces{
    ExternalForce::body_force, ExternalForce::surface_load, ExternalForce::point_load, ExternalForce::spring,
    ExternalForce::dashpot};
/// What people call it, as a row of the ledger.
constexpr const char* name_of(ExternalForce force) {
  constexpr std::array<const char*, external_force_count> names{"body force", "surface load", "point load", "spring",
                                                                "dashpot"};
  return names[static_cast<std::size_t>(force)];
}
constexpr const char* field_of(ExternalForce force) {
  return external_fields[static_cast<std::size_t>(force)];
}

enum class LoadType { traction, pressure, force, line_force, body_force, spring };

struct Load {
  LoadType type = LoadType::traction;
  int body = 0;                           ///< index into Experiment::bodies
  std::shared_ptr<const Geometry> where;  ///< what of the body's surface is loaded, where it is a part of that
  /// Traction, Pa; force, N; force a length, N/m; acceleration, N/kg; of a pressure its first component is the
  /// pressure, Pa. At (x, y, z), (X, Y, Z) where the loaded point began, and t.
  VectorExpression value;
  bool follower = false;                         ///< a pressure acts along the current normal, on the current area
  Vector3 from{}, to{};                          ///< m, ends of a line; a point is its `from`
  std::array<double, 3> stiffness{}, damping{};  ///< N/m^3 and N s/m^3 along each axis, of a spring
  std::string pointer;

  bool on_surface() const {
    return type == LoadType::traction || type == LoadType::pressure || type == LoadType::spring;
  }
  /// Whether it acts at points, which lie beside the particles that carry them.
  bool at_points() const { return type != LoadType::body_force; }
  bool gives(ExternalForce force) const;
};

/// The value of a load as the file and messages name it.
struct LoadValue {
  const char *key, *name, *unit;
  bool is_vector;  ///< the file has a list of components
};
/// That of a type of load; a spring has none.
LoadValue value_of(LoadType type);

/// The pieces of a body's surface that a load acts on.
Surface loaded_surface(const Load& load, const Geometry& body, const std::pair<Vector3, Vector3>& domain,
                       double spacing);

}  // namespace mpm
