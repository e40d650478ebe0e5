#include "experiment/loads.hpp"

#include <algorithm>
#include <stdexcept>

namespace mpm {

bool Load::gives(ExternalForce force) const {
  const auto any = [](const std::array<double, 3>& values) {
    return std::any_of(values.begin(), values.end(), [](double value) { return value != 0; });
  };
  switch (force) {
    case ExternalForce::body_force:
      return type == LoadType::body_force;
    case ExternalForce::surface_load:
      return type == LoadType::traction || type == LoadType::pressure;
    case ExternalForce::point_load:
      return type == LoadType::force || type == LoadType::line_force;
    case ExternalForce::spring:
      return type == LoadType::spring && any(stiffness);
    case ExternalForce::dashpot:
      return type == LoadType::spring && any(damping);
  }
  return false;
}

LoadValue value_of(LoadType type) {
  switch (type) {
    case LoadType::traction:
      return {"traction", "traction", "Pa", true};
    case LoadType::pressure:
      return {"pressure", "pressure", "Pa", false};
    case LoadType::force:
      return {"force", "force", "N", true};
    case LoadType::line_force:
      return {"force", "force per length", "N/m", true};
    case LoadType::body_force:
      return {"acceleration", "body force", "N/kg", true};
    case LoadType::spring:
      break;
  }
  throw std::logic_error("a spring has no value");
}

Surface loaded_surface(const Load& load, const Geometry& body, const std::pair<Vector3, Vector3>& domain,
                       double spacing) {
  Surface loaded;
  const double beside = 1e-6 * spacing;
  for (const SurfacePiece& piece : body.surface(spacing, domain)) {
    // A surface that coincides with that of `where` counts as inside, whatever rounding makes of its points.
    bool inside = false, within = true;
    for (const double shift : {0.0, beside, -beside}) {
      Vector3 point = piece.point;
      for (int i = 0; i < 3; ++i) point[i] += shift * piece.normal[i];
      inside = inside || load.where->contains(point);
    }
    for (int i = 0; i < 3; ++i)
      within = within && piece.point[i] >= domain.first[i] - beside && piece.point[i] <= domain.second[i] + beside;
    if (inside && within) loaded.push_back(piece);
  }
  return loaded;
}

}  // namespace mpm
