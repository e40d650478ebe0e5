#include "simulation/contact_pair.hpp"

#include <algorithm>

namespace mpm {
namespace {

/// The arrays of a call for normals, with the last pair once more in all lanes that are left over.
struct NormalArrays {
  using Vectors = std::array<double, 3 * MPM_BATCH>;
  alignas(64) Vectors mass_gradient_a, mass_gradient_b, volume_gradient_a, volume_gradient_b;
  alignas(64) Vectors normal{}, own_a{}, own_b{};
  alignas(64) std::array<std::int32_t, MPM_BATCH> found{};
  std::uint32_t count;

  NormalArrays(std::span<const MetPair> pairs, int dimension)
      : count((static_cast<std::uint32_t>(pairs.size()) + MPM_LANES - 1) / MPM_LANES * MPM_LANES) {
    for (std::size_t lane = 0; lane < count; ++lane) {
      const MetPair& pair = pairs[std::min(lane, pairs.size() - 1)];
      for (std::size_t c = 0; c < static_cast<std::size_t>(dimension); ++c) {
        const std::size_t at = c * MPM_BATCH + lane;
        mass_gradient_a[at] = pair.a.mass_gradient[c], mass_gradient_b[at] = pair.b.mass_gradient[c];
        volume_gradient_a[at] = pair.a.volume_gradient[c], volume_gradient_b[at] = pair.b.volume_gradient[c];
      }
    }
  }

  mpm_normal_batch request(unsigned traits, int dimension) {
    const bool masses = traits & MPM_READS_MASS_GRADIENT, volumes = traits & MPM_READS_VOLUME_GRADIENT,
               own = traits & MPM_OWN_NORMALS;
    return {count,
            MPM_BATCH,
            static_cast<std::uint32_t>(dimension),
            0,
            masses ? mass_gradient_a.data() : nullptr,
            masses ? mass_gradient_b.data() : nullptr,
            volumes ? volume_gradient_a.data() : nullptr,
            volumes ? volume_gradient_b.data() : nullptr,
            normal.data(),
            own ? own_a.data() : nullptr,
            own ? own_b.data() : nullptr,
            found.data()};
  }
};

}  // namespace

/// Asks the plugin for the normals of pairs, from sums over their nodes.
void PairGeometry::find_normals(std::span<MetPair> pairs) const {
  const int D = experiment_.dimension;
  const Component& normal = *experiment_.contact_normal;
  const mpm_normal& functions = normal.plugin->normal();
  NormalArrays arrays(pairs, D);
  const mpm_normal_batch request = arrays.request(functions.traits, D);
  functions.from_sums[entry_][D - 2](normal.parameters.data(), &request);
  for (std::size_t lane = 0; lane < pairs.size(); ++lane) {
    ContactGeometry& geometry = pairs[lane].geometry;
    geometry.valid = arrays.found[lane] != 0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(D); ++c) {
      const std::size_t at = c * MPM_BATCH + lane;
      geometry.normal[c] = arrays.normal[at];
      geometry.own_a[c] = arrays.own_a[at], geometry.own_b[c] = arrays.own_b[at];
    }
  }
}

/// Finds a pair's geometry by its particles, along the normal from sums that it has already where they give none.
void PairGeometry::find_by_points(const ContactPoints& points, int field_a, int field_b, MetPair& pair) const {
  const int D = experiment_.dimension;
  ContactGeometry& geometry = pair.geometry;
  const SeparatedPair seen = points.pair(pair.node, field_a, field_b);
  const bool by_points = seen.parted;
  if (points.gives_normal()) geometry.valid = by_points || average_gradient(pair.a, pair.b, D, geometry.normal);
  geometry.valid = geometry.valid && seen.found;
  if (!geometry.valid) return;
  if (by_points) std::copy(seen.normal.begin(), seen.normal.end(), geometry.normal);
  measure(field_a, field_b, pair);
  if (!points.gives_separation()) return;
  const Vector3 along{geometry.normal[0], geometry.normal[1], geometry.normal[2]};
  geometry.separation = by_points ? seen.separation : points.separation(pair.node, field_a, field_b, along);
}

void PairGeometry::measure(int field_a, int field_b, MetPair& pair) const {
  const double h = experiment_.grid.cell_size;
  const double around = experiment_.axisymmetric() ? around_axis(experiment_.grid.lower[0] + pair.node[0] * h) : 1.0;
  measure_pair(pair.geometry, pair.a, pair.b, edges_[static_cast<std::size_t>(field_a)].table(),
               edges_[static_cast<std::size_t>(field_b)].table(), h, experiment_.dimension, around);
}

void PairGeometry::find(const ContactPoints& points, int field_a, int field_b, std::span<MetPair> pairs) const {
  if (pairs.empty()) return;
  if (!points.gives_normal()) find_normals(pairs);
  for (MetPair& pair : pairs)
    if (points.needed())
      find_by_points(points, field_a, field_b, pair);
    else if (pair.geometry.valid)
      measure(field_a, field_b, pair);
}

}  // namespace mpm
