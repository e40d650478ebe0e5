#include "experiment/places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "experiment/measure.hpp"
#include "experiment/scattered_places.hpp"

namespace mpm {
namespace {

using Index = std::array<long, 3>;

/// The cells of a lattice that a region may reach.
struct Lattice {
  Frame frame;
  Vector3 first_corner{}, spacing{};  ///< in the frame, of cell (0, 0, 0)
  Index first{}, last{};

  Vector3 corner(const Index& at, double shift) const {
    Vector3 local{};
    for (int c = 0; c < 3; ++c) local[c] = first_corner[c] + (static_cast<double>(at[c]) + shift) * spacing[c];
    return local;
  }
  template <class Visit>
  void for_each_cell(Visit&& visit) const {
    for (long k = first[2]; k <= last[2]; ++k)
      for (long j = first[1]; j <= last[1]; ++j)
        for (long i = first[0]; i <= last[0]; ++i) visit(Index{i, j, k});
  }
};

double product(const Vector3& sides, int dimension) {
  return dimension == 2 ? sides[0] * sides[1] : sides[0] * sides[1] * sides[2];
}

double spacing_of(const PlacingScene& scene, const BodySpecification& body) {
  return scene.grid.cell_size / body.particles_per_cell_axis;
}

/// The cells of the grid's own lattice around a region.
Lattice lattice_of_grid(const PlacingScene& scene, const BodySpecification& body, const Geometry& region) {
  Lattice lattice;
  const double spacing = spacing_of(scene, body);
  const auto [lower, upper] = region.bounds();
  for (int c = 0; c < scene.dimension; ++c) {
    lattice.first_corner[c] = scene.grid.lower[c], lattice.spacing[c] = spacing;
    const long most = static_cast<long>(scene.grid.cells[c]) * body.particles_per_cell_axis - 1;
    lattice.first[c] = std::max(0L, static_cast<long>(std::floor((lower[c] - scene.grid.lower[c]) / spacing)) - 1);
    lattice.last[c] = std::min(most, static_cast<long>(std::floor((upper[c] - scene.grid.lower[c]) / spacing)) + 1);
  }
  return lattice;
}

/// The cells of a body's own lattice. Rows fill a region that has faces across the axes; else they lie on both sides of
/// its middle.
Lattice lattice_of_body(const PlacingScene& scene, const BodySpecification& body, const Geometry& region) {
  Lattice lattice;
  lattice.frame = body.geometry->frame();
  const double wanted = spacing_of(scene, body);
  for (int c = 0; c < scene.dimension; ++c) {
    double offset = 0;
    for (int i = 0; i < 3; ++i) offset += lattice.frame.axes[c][i] * lattice.frame.origin[i];
    const auto [low, high] = region.extent(lattice.frame.axes[c]);
    lattice.spacing[c] = wanted;
    if (lattice.frame.filled) {
      const double side = lattice.frame.upper[c] - lattice.frame.lower[c];
      lattice.spacing[c] = side / std::max(1.0, std::round(side / wanted));
      lattice.first_corner[c] = lattice.frame.lower[c];
    }
    const double from = (low - offset - lattice.first_corner[c]) / lattice.spacing[c];
    const double to = (high - offset - lattice.first_corner[c]) / lattice.spacing[c];
    lattice.first[c] = static_cast<long>(std::floor(from + 1e-9));
    lattice.last[c] = static_cast<long>(std::ceil(to - 1e-9)) - 1;
  }
  return lattice;
}

constexpr int depth_of_measure = 3;  ///< eighths of a spacing

/// What a region holds, in the frame of the world; of rings the moment along the radius is their volume over 2 pi.
Measured measure_all(const PlacingScene& scene, const BodySpecification& body, const Geometry& region) {
  Measured sum;
  const Lattice cells = lattice_of_grid(scene, body, region);
  cells.for_each_cell([&](const Index& at) {
    sum.add(measure(region, scene.dimension, cells.frame, cells.corner(at, 0), cells.corner(at, 1), depth_of_measure));
  });
  return sum;
}

/// Semi-sides of a box along a frame's axes.
std::vector<double> box_along(const Frame& frame, const Vector3& half, int dimension) {
  std::vector<double> box;
  for (int i = 0; i < dimension; ++i)
    for (int k = 0; k < dimension; ++k) box.push_back(frame.axes[k][i] * half[k]);
  return box;
}

Places place_fitted(const PlacingScene& scene, const BodySpecification& body, const Geometry& region) {
  const int D = scene.dimension;
  const Lattice lattice = lattice_of_body(scene, body, region);
  Places places;
  places.spacing = lattice.spacing;
  places.volume = product(lattice.spacing, D);
  places.boxes = box_along(lattice.frame, {lattice.spacing[0] / 2, lattice.spacing[1] / 2, lattice.spacing[2] / 2}, D);
  double cells = 0;
  lattice.for_each_cell([&](const Index& at) {
    const Vector3 point = lattice.frame.to_world(lattice.corner(at, 0.5));
    if (region.contains(point)) places.points.push_back(point);
    ++cells;
  });
  double side = 1;
  for (int c = 0; c < D; ++c) side *= lattice.frame.upper[c] - lattice.frame.lower[c];
  const double count = static_cast<double>(places.points.size());
  if (places.points.empty() || (lattice.frame.filled && count == cells && count * places.volume >= side * (1 - 1e-9)))
    return places;
  // A rim across the lattice leaves the count to chance; the volume of each makes good for it.
  const Measured all = measure_all(scene, body, region);
  double weight = 0;
  const bool rings = scene.grid.symmetry == Symmetry::axisymmetric;
  for (const Vector3& point : places.points) weight += rings ? point[0] : 1;
  places.volume = (rings ? all.moment[0] : all.volume) / weight;
  return places;
}

/// Gives what the lightest cells hold to their heaviest neighbours. A piece that has none is dropped.
void merge_slivers(std::map<Index, Measured>& cells, double least, int dimension) {
  std::vector<std::pair<double, Index>> light;
  for (const auto& [at, held] : cells)
    if (held.volume < least) light.push_back({held.volume, at});
  std::sort(light.begin(), light.end());
  for (const auto& [volume, at] : light) {
    const Measured sliver = cells.at(at);
    if (sliver.volume >= least) continue;  // it has taken another one
    Measured* heaviest = nullptr;
    const int deep = dimension == 2 ? 0 : 1;
    for (int k = -deep; k <= deep; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          const auto found = cells.find({at[0] + i, at[1] + j, at[2] + k});
          if ((i || j || k) && found != cells.end() && (!heaviest || found->second.volume > heaviest->volume))
            heaviest = &found->second;
        }
    if (heaviest) heaviest->add(sliver);
    cells.erase(at);
  }
}

/// The box of a particle along the axes: of its volume, with the proportions that its second moments have.
Vector3 half_of(const Measured& held, int dimension) {
  Vector3 half{};
  double volume = 1;
  for (int c = 0; c < dimension; ++c) {
    const double mean = held.moment[c] / held.volume, variance = held.second[c] / held.volume - mean * mean;
    half[c] = std::sqrt(3 * std::max(variance, 0.0));
    volume *= 2 * half[c];
  }
  const double factor = std::pow(held.volume / volume, 1.0 / dimension);
  for (int c = 0; c < dimension; ++c) half[c] *= factor;
  return half;
}

Places place_partial(const PlacingScene& scene, const BodySpecification& body, const Geometry& region) {
  const int D = scene.dimension;
  const Lattice lattice = lattice_of_grid(scene, body, region);
  Places places;
  places.spacing = lattice.spacing;
  places.volume = nominal_volume(scene.grid, D, body);
  std::map<Index, Measured> cells;
  lattice.for_each_cell([&](const Index& at) {
    const Measured held =
        measure(region, D, lattice.frame, lattice.corner(at, 0), lattice.corner(at, 1), depth_of_measure);
    if (held.volume > 0) cells[{at[0], at[1], at[2]}] = held;
  });
  merge_slivers(cells, body.seeding.smallest_share * places.volume, D);
  std::vector<std::pair<std::array<long, 3>, const Measured*>> order;
  for (const auto& [at, held] : cells) order.push_back({{at[2], at[1], at[0]}, &held});
  std::sort(order.begin(), order.end());  // rows along x, as on the lattice
  for (const auto& [reversed, held] : order) {
    const Vector3 half = half_of(*held, D);
    const std::vector<double> box = box_along(lattice.frame, half, D);
    places.points.push_back(held->whole ? lattice.corner({reversed[2], reversed[1], reversed[0]}, 0.5)
                                        : held->middle());
    places.shares.push_back(held->whole ? 1 : held->volume / places.volume);
    places.boxes.insert(places.boxes.end(), box.begin(), box.end());
  }
  return places;
}

/// Boxes along the axes, equal in all directions.
void add_even_boxes(Places& places, int dimension) {
  places.boxes.clear();
  for (std::size_t p = 0; p < places.points.size(); ++p) {
    const double volume = places.volume * (places.shares.empty() ? 1 : places.shares[p]);
    const double half = std::pow(volume, 1.0 / dimension) / 2;
    const std::vector<double> box = box_along({}, {half, half, half}, dimension);
    places.boxes.insert(places.boxes.end(), box.begin(), box.end());
  }
}

/// Small even pieces of the region, which stand for its points.
std::vector<Piece> samples_of(const PlacingScene& scene, const BodySpecification& body, const Geometry& region) {
  std::vector<Piece> samples;
  const Lattice cells = lattice_of_grid(scene, body, region);
  cells.for_each_cell([&](const Index& at) {
    for_each_piece(region, scene.dimension, cells.frame, cells.corner(at, 0), cells.corner(at, 1), 2, true,
                   [&](const Piece& piece) { samples.push_back(piece); });
  });
  return samples;
}

Places place_scattered(const PlacingScene& scene, const BodySpecification& body, const Geometry& region) {
  Places places;
  const double spacing = spacing_of(scene, body);
  for (int c = 0; c < scene.dimension; ++c) places.spacing[c] = spacing;
  places.volume = nominal_volume(scene.grid, scene.dimension, body);
  const Measured all = measure_all(scene, body, region);
  const auto count = static_cast<std::size_t>(std::round(all.volume / places.volume));
  if (count == 0) return places;
  Scattered scattered(scene.dimension, spacing, samples_of(scene, body, region), all);
  scattered.throw_points(region, count, scene.seed);
  if (body.seeding.kind == SeedingKind::blue_noise)
    scattered.relax(body.seeding.relaxations);
  else
    scattered.share_out(0.05 * places.volume);
  places.points = scattered.points();
  for (const double volume : scattered.volumes()) places.shares.push_back(volume / places.volume);
  add_even_boxes(places, scene.dimension);
  return places;
}

Places place_points(const PlacingScene& scene, const BodySpecification& body) {
  Places places;
  const double spacing = spacing_of(scene, body);
  for (int c = 0; c < scene.dimension; ++c) places.spacing[c] = spacing;
  places.volume = nominal_volume(scene.grid, scene.dimension, body);
  const bool rings = scene.grid.symmetry == Symmetry::axisymmetric;
  for (const SeededPoint& point : *body.seeding.points) {
    places.points.push_back(point.place);
    const double section = rings ? point.volume / (2 * std::numbers::pi * point.place[0]) : point.volume;
    if (body.seeding.points_have_volumes) places.shares.push_back(section / places.volume);
  }
  add_even_boxes(places, scene.dimension);
  return places;
}

/// The region cut off by the domain where it has no bound of its own.
GeometryPointer bounded(const PlacingScene& scene, const BodySpecification& body) {
  const auto [lower, upper] = body.geometry->bounds();
  for (int c = 0; c < scene.dimension; ++c)
    if (!std::isfinite(lower[c]) || !std::isfinite(upper[c]))
      return make_intersection({body.geometry, make_box(scene.dimension, scene.grid.lower, scene.grid.upper)});
  return body.geometry;
}

}  // namespace

double nominal_volume(const GridSpecification& grid, int dimension, const BodySpecification& body) {
  return std::pow(grid.cell_size / body.particles_per_cell_axis, dimension);
}

Places place_particles(const PlacingScene& scene, const BodySpecification& body) {
  if (body.seeding.kind == SeedingKind::points) return place_points(scene, body);
  const GeometryPointer region = bounded(scene, body);
  if (body.seeding.kind == SeedingKind::fitted) return place_fitted(scene, body, *region);
  if (body.seeding.kind == SeedingKind::partial) return place_partial(scene, body, *region);
  return place_scattered(scene, body, *region);
}

}  // namespace mpm
