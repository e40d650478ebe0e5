// STL files: text ("solid … facet … vertex x y z") and binary (80 bytes, a count, 50 bytes a facet).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

#include "experiment/diagnostics.hpp"
#include "experiment/surface_mesh.hpp"
#include "support/files.hpp"

namespace mpm {
namespace {

constexpr std::size_t header_bytes = 84, facet_bytes = 50;

std::string place_of(const SurfaceMesh& surface, std::size_t triangle) {
  return (surface.is_text ? "line " : "byte ") + std::to_string(surface.places[triangle]) + ": ";
}

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

SurfaceMesh read_binary(const std::string& bytes, double scale) {
  const std::size_t count = value_at<std::uint32_t>(bytes, 80), wanted = header_bytes + count * facet_bytes;
  if (bytes.size() < wanted)
    throw SurfaceError("byte " + std::to_string(bytes.size()) + ": the file ends here, and its " +
                       std::to_string(count) + " facets take " + std::to_string(wanted) + " bytes");
  SurfaceMesh surface;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = header_bytes + k * facet_bytes;
    Triangle triangle;
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (std::size_t c = 0; c < 3; ++c)
        triangle[corner][c] = scale * value_at<float>(bytes, at + 12 + 12 * corner + 4 * c);
    surface.triangles.push_back(triangle), surface.places.push_back(at);
  }
  return surface;
}

/// Reads a line "vertex x y z".
Vector3 vertex_of(std::istringstream& words, std::size_t line, double scale) {
  Vector3 point{};
  for (double& x : point)
    if (!(words >> x)) throw SurfaceError("line " + std::to_string(line) + ": expected \"vertex\" and three numbers");
  for (double& x : point) x *= scale;
  return point;
}

SurfaceMesh read_text(const std::string& bytes, double scale) {
  SurfaceMesh surface;
  surface.is_text = true;
  std::istringstream lines(bytes);
  std::vector<Vector3> corners;
  std::size_t number = 0, facet_line = 0;
  bool ended = false;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream words(line);
    std::string word;
    if (!(words >> word)) continue;
    if (word == "facet") facet_line = number, corners.clear();
    if (word == "vertex") corners.push_back(vertex_of(words, number, scale));
    if (word == "endsolid") ended = true;
    if (word == "endfacet") {
      if (corners.size() != 3)
        throw SurfaceError("line " + std::to_string(number) + ": a facet of " + std::to_string(corners.size()) +
                           " corners; expected 3");
      surface.triangles.push_back({corners[0], corners[1], corners[2]}), surface.places.push_back(facet_line);
    }
    const char* const known[] = {"solid", "facet", "outer", "vertex", "endloop", "endfacet", "endsolid"};
    if (std::none_of(std::begin(known), std::end(known), [&](const char* k) { return word == k; }))
      throw SurfaceError("line " + std::to_string(number) + ": " + in_quotes(word) + " has no meaning in STL");
  }
  if (!ended) throw SurfaceError("line " + std::to_string(number) + ": the file ends before \"endsolid\"");
  return surface;
}

}  // namespace

SurfaceMesh read_stl(const std::filesystem::path& path, double scale) {
  const std::string bytes = support::read_file(path);
  // Some programs begin binary files with "solid" too; their length tells.
  const bool fits = bytes.size() >= header_bytes &&
                    bytes.size() == header_bytes + std::size_t(value_at<std::uint32_t>(bytes, 80)) * facet_bytes;
  const bool is_text = !fits && bytes.compare(0, 5, "solid") == 0;
  if (!is_text && bytes.size() < header_bytes)
    throw SurfaceError("it is no STL file: neither text that begins with \"solid\" nor 84 bytes of a binary one");
  SurfaceMesh surface = is_text ? read_text(bytes, scale) : read_binary(bytes, scale);
  if (surface.triangles.empty()) throw SurfaceError("it holds no facet");
  for (std::size_t k = 0; k < surface.triangles.size(); ++k)
    for (const Vector3& corner : surface.triangles[k])
      for (const double x : corner)
        if (!std::isfinite(x)) throw SurfaceError(place_of(surface, k) + "a corner is not finite");
  return surface;
}

void check_closed(const SurfaceMesh& surface) {
  std::map<std::pair<Vector3, Vector3>, std::pair<int, std::size_t>> edges;  // times, and the first triangle
  for (std::size_t k = 0; k < surface.triangles.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      const Vector3 &a = surface.triangles[k][c], &b = surface.triangles[k][(c + 1) % 3];
      if (a == b) continue;
      ++edges.try_emplace(std::minmax(a, b), 0, k).first->second.first;
    }
  const std::pair<const std::pair<Vector3, Vector3>, std::pair<int, std::size_t>>* first = nullptr;
  std::size_t open = 0;
  for (const auto& edge : edges) {
    if (edge.second.first % 2 == 0) continue;
    ++open;
    if (!first || edge.second.second < first->second.second) first = &edge;
  }
  if (!first) return;
  std::ostringstream text;
  const auto& [ends, found] = *first;
  text << place_of(surface, found.second) << "the surface is not closed: " << found.first
       << (found.first == 1 ? " facet meets" : " facets meet") << " at the edge from (" << ends.first[0] << ", "
       << ends.first[1] << ", " << ends.first[2] << ") to (" << ends.second[0] << ", " << ends.second[1] << ", "
       << ends.second[2] << ") m; there are " << open << " such edges";
  throw SurfaceError(text.str());
}

}  // namespace mpm
