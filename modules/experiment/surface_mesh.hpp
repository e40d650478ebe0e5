#pragma once
// Closed surfaces of triangles, and the STL files that they come in.

#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/geometry.hpp"

namespace mpm {

using Triangle = std::array<Vector3, 3>;  ///< corners, m

/// A surface as a file holds it.
struct SurfaceMesh {
  std::vector<Triangle> triangles;
  std::vector<std::size_t> places;  ///< line (text) or byte (binary) of each, from 1 and from 0
  bool is_text = false;
};

/// A file that is no surface; the message begins with the place in it, where there is one: "line 12: ".
class SurfaceError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads STL, text or binary, and multiplies lengths by `scale`. Throws SurfaceError.
SurfaceMesh read_stl(const std::filesystem::path& path, double scale);

/// Throws SurfaceError, with the first place, unless an even number of triangles meets at each edge.
void check_closed(const SurfaceMesh& surface);

/// What a closed surface encloses, by the number of times that a ray passes it.
GeometryPointer make_enclosed(std::vector<Triangle> triangles);

}  // namespace mpm
