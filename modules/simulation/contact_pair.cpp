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

/// The arrays of a call for gaps.
struct GapArrays {
  using Values = std::array<double, MPM_BATCH>;
  alignas(64) Values mean_a, mean_b, edge_a, edge_b, surface_a, surface_b, gap;

  void set(std::size_t lane, const DetectionPair<double>& seen) {
    mean_a[lane] = seen.mean_a, mean_b[lane] = seen.mean_b;
    edge_a[lane] = seen.edge_a, edge_b[lane] = seen.edge_b;
    surface_a[lane] = seen.surface_a, surface_b[lane] = seen.surface_b;
  }

  /// The last pair stands once more in all lanes that are left over.
  mpm_detection_batch request(unsigned traits, std::size_t pairs) {
    const std::size_t count = (pairs + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
    for (Values* values : {&mean_a, &mean_b, &edge_a, &edge_b, &surface_a, &surface_b})
      std::fill(values->data() + pairs, values->data() + count, (*values)[pairs - 1]);
    const auto given = [&](unsigned trait, Values& values) { return traits & trait ? values.data() : nullptr; };
    return {static_cast<std::uint32_t>(count),
            MPM_BATCH,
            given(MPM_READS_MEAN_POSITION, mean_a),
            given(MPM_READS_MEAN_POSITION, mean_b),
            given(MPM_READS_EDGES, edge_a),
            given(MPM_READS_EDGES, edge_b),
            given(MPM_READS_PARTICLE_SURFACES, surface_a),
            given(MPM_READS_PARTICLE_SURFACES, surface_b),
            gap.data()};
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

/// Finds a pair's normal by its particles where these are parted; else the one from sums stands.
void PairGeometry::find_normal_by_points(const SeparatedPair& seen, MetPair& pair) const {
  ContactGeometry& geometry = pair.geometry;
  if (seen.parted) std::copy(seen.normal.begin(), seen.normal.end(), geometry.normal);
  geometry.valid = seen.parted || average_gradient(pair.a, pair.b, experiment_.dimension, geometry.normal);
}

DetectionPair<double> PairGeometry::seen_along_normal(const ContactPoints& points, int field_a, int field_b,
                                                      const MetPair& pair) const {
  const unsigned traits = experiment_.contact_detection->plugin->detection().traits;
  const double* normal = pair.geometry.normal;
  DetectionPair<double> seen{};
  if (traits & (MPM_READS_MEAN_POSITION | MPM_READS_EDGES))
    see_means(seen, pair.a, pair.b, normal, experiment_.grid.cell_size, experiment_.dimension);
  if (traits & MPM_READS_EDGES)
    see_edges(seen, edges_[static_cast<std::size_t>(field_a)].table(),
              edges_[static_cast<std::size_t>(field_b)].table());
  if (!(traits & MPM_READS_MEAN_POSITION)) seen.mean_a = seen.mean_b = 0;
  if (points.sees_surfaces()) {
    const SeparatedPair found = points.pair(pair.node, field_a, field_b);
    const SurfacePlaces surfaces =
        found.parted ? SurfacePlaces{found.surface_a, found.surface_b}
                     : points.surfaces(pair.node, field_a, field_b, {normal[0], normal[1], normal[2]});
    seen.surface_a = surfaces.of_a, seen.surface_b = surfaces.of_b;
  }
  return seen;
}

double PairGeometry::area_of(const MetPair& pair) const {
  const double h = experiment_.grid.cell_size;
  const double around = experiment_.axisymmetric() ? around_axis(experiment_.grid.lower[0] + pair.node[0] * h) : 1.0;
  return contact_area(pair.a, pair.b, pair.geometry.normal, experiment_.dimension, around);
}

/// Asks the plugin for the gaps of those pairs that have a normal, which are closed in a weld, and finds their areas.
void PairGeometry::find_gaps(const ContactPoints& points, int field_a, int field_b, std::span<MetPair> pairs) const {
  if (experiment_.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION) {
    for (MetPair& pair : pairs)
      if (pair.geometry.valid) pair.geometry.area = area_of(pair);
    return;
  }
  const Component& detection = *experiment_.contact_detection;
  GapArrays arrays;
  std::size_t count = 0;
  for (const MetPair& pair : pairs)
    if (pair.geometry.valid) arrays.set(count++, seen_along_normal(points, field_a, field_b, pair));
  if (count == 0) return;
  const mpm_detection& functions = detection.plugin->detection();
  const mpm_detection_batch request = arrays.request(functions.traits, count);
  functions.find[entry_](detection.parameters.data(), &request);
  count = 0;
  for (MetPair& pair : pairs) {
    if (!pair.geometry.valid) continue;
    pair.geometry.separation = arrays.gap[count++] * experiment_.grid.cell_size;
    pair.geometry.area = area_of(pair);
  }
}

void PairGeometry::find(const ContactPoints& points, int field_a, int field_b, std::span<MetPair> pairs) const {
  if (pairs.empty()) return;
  if (!points.gives_normal()) find_normals(pairs);
  if (points.needed())
    for (MetPair& pair : pairs) {
      const SeparatedPair seen = points.pair(pair.node, field_a, field_b);
      if (points.gives_normal()) find_normal_by_points(seen, pair);
      pair.geometry.valid = pair.geometry.valid && seen.found;
    }
  find_gaps(points, field_a, field_b, pairs);
}

}  // namespace mpm
