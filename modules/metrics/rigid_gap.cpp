#include "metrics/rigid_gap.hpp"

#include <cmath>
#include <limits>

#include "metrics/particle_domain.hpp"
#include "metrics/probes.hpp"
#include "simulation/rigid_place.hpp"
#include "support/numbers.hpp"

namespace mpm {
namespace {

/// How far the ellipsoid with these semi-axes extends along a vector, times the vector's length.
double extent(const std::array<double, 9>& sides, const Vector3& along) {
  double squared = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double part = along[0] * sides[a] + along[1] * sides[3 + a] + along[2] * sides[6 + a];
    squared += part * part;
  }
  return std::sqrt(squared);
}

double longest(const std::array<double, 9>& sides) {
  double squared = 0;
  for (const double side : sides) squared += side * side;
  return std::sqrt(squared);
}

}  // namespace

double rigid_gap(Views& views, std::size_t rigid_body, const RigidState& state) {
  const Experiment& experiment = views.experiment();
  const RigidBodySpecification& rigid = experiment.rigid_bodies[rigid_body];
  const auto D = static_cast<std::size_t>(experiment.dimension);
  const double step = 1e-4 * experiment.grid.cell_size;
  const auto distance = [&](const Vector3& x) { return rigid.geometry->distance(place_at_start(rigid, state, x)); };
  double gap = support::infinity;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyView& view = views.of(body);
    for (std::size_t p = 0; p < view.count; ++p) {
      Vector3 x{}, slope{};
      for (std::size_t c = 0; c < D; ++c) x[c] = view.state.position[p * D + c];
      const double middle = distance(x);
      const std::array<double, 9> sides = semi_sides(experiment, body, view.state, p);
      if (!(middle - longest(sides) < gap)) continue;
      for (std::size_t c = 0; c < D; ++c) {
        Vector3 above = x, below = x;
        above[c] += step, below[c] -= step;
        slope[c] = (distance(above) - distance(below)) / (2 * step);
      }
      const double length = std::sqrt(slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2]);
      gap = std::min(gap, middle - (length > 0 ? extent(sides, slope) / length : longest(sides)));
    }
  }
  return gap < support::infinity ? gap : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace mpm
