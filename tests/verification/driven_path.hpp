#pragma once
// One particle of a plugin's material along an imposed path, from a few words of JSON.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "drive/read_drive.hpp"
#include "plugin/registry.hpp"
#include "support/catch.hpp"

namespace mpm::driven_path {

using Json = nlohmann::ordered_json;

inline const ComponentLookup& lookup() {
  static const Registry registry = Registry::from_folders(Registry::default_folders());
  static const ComponentLookup components(registry);
  return components;
}

/// `cell_size` in m, for materials that read one.
inline drive::DriveExperiment path_of(const Json& material, const Json& stages, int dimension = 3,
                                      std::optional<double> cell_size = {}) {
  Json file{{"dimension", dimension},
            {"materials", {{"m", material}}},
            {"solver", {{"type", "material_point"}, {"stages", stages}}}};
  if (cell_size) file["solver"]["cell_size"] = *cell_size;
  return drive::read_drive_text(file.dump(), "FILE", lookup());
}

inline drive::Course driven(const Json& material, const Json& stages, int dimension = 3,
                            drive::Slopes slopes = drive::Slopes::tangent) {
  return drive::follow(path_of(material, stages, dimension), slopes);
}

/// A stage to values of F, with stresses in place of others.
inline Json stage(const Json& F, int steps = 1, const Json& stress = nullptr) {
  Json json{{"steps", steps}, {"deformation_gradient", F}};
  if (!stress.is_null()) json["stress"] = stress;
  return json;
}

inline const drive::Row& end_of(const drive::Course& course) {
  INFO((course.stop ? course.stop->reason : ""));
  REQUIRE(!course.stop);
  return course.rows.back();
}

}  // namespace mpm::driven_path
