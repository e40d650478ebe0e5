#pragma once
// Paths that say what any material is like: their experiments, ready to be run.

#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace mpm::drive {

struct StandardPath {
  const char *name, *doc;
  const char* modulus;  ///< what its first step measures, in 3-D: "E", "G", "K", "M"
};
/// uniaxial, simple_shear, isotropic, cyclic, oedometer.
std::span<const StandardPath> standard_paths();

struct PathSize {
  double strain = 0.1;  ///< largest displacement gradient, above 0 and below 1
  double duration = 1;  ///< s, of one way
  int steps = 100;      ///< steps of one way
  int dimension = 3;
};

/// The experiment of a standard path with a material, as it stands under "materials" of a file. Throws
/// std::invalid_argument where there is no path of that name.
nlohmann::ordered_json standard_path(const std::string& name, const PathSize& size,
                                     const nlohmann::ordered_json& material);

}  // namespace mpm::drive
