#include "simulation/rigid_outline.hpp"

#include <cmath>

namespace mpm {
namespace {

/// A vector of the plane turned by a rotation, or back by it.
Vector3 turned(const std::array<Vector3, 3>& rotation, const Vector3& x, bool back) {
  Vector3 result{};
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t c = 0; c < 2; ++c) result[row] += (back ? rotation[c][row] : rotation[row][c]) * x[c];
  return result;
}

}  // namespace

std::vector<std::pair<Vector3, Vector3>> edges_of(const Experiment& experiment, std::size_t body,
                                                  const RigidState& state) {
  const RigidBodySpecification& specification = experiment.rigid_bodies[body];
  const GridSpecification& grid = experiment.grid;
  // A box as wide as the diagonal of the domain holds it however the body has turned.
  Vector3 middle{};
  const double size = std::hypot(grid.upper[0] - grid.lower[0], grid.upper[1] - grid.lower[1]);
  for (std::size_t c = 0; c < 2; ++c) middle[c] = 0.5 * (grid.lower[c] + grid.upper[c]) - state.place[c];
  middle = turned(state.rotation, middle, true);
  std::pair<Vector3, Vector3> around;
  for (std::size_t c = 0; c < 2; ++c) {
    around.first[c] = specification.about[c] + middle[c] - 0.5 * size;
    around.second[c] = specification.about[c] + middle[c] + 0.5 * size;
  }
  std::vector<std::pair<Vector3, Vector3>> edges;
  for (const SurfacePiece& piece : specification.geometry->surface(0.5 * grid.cell_size, around)) {
    const Vector3 along{-0.5 * piece.area * piece.normal[1], 0.5 * piece.area * piece.normal[0], 0};
    const auto now = [&](double sign) {
      Vector3 x{};
      for (std::size_t c = 0; c < 2; ++c) x[c] = piece.point[c] - specification.about[c] + sign * along[c];
      x = turned(state.rotation, x, false);
      for (std::size_t c = 0; c < 3; ++c) x[c] += state.place[c];
      return x;
    };
    edges.emplace_back(now(-1), now(1));
  }
  return edges;
}

}  // namespace mpm
