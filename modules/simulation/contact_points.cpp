#include "simulation/contact_points.hpp"

#include <algorithm>
#include <cmath>

#include "operators/contact_points.hpp"
#include "simulation/boundary.hpp"
#include "simulation/contact_impulse.hpp"

namespace mpm {
namespace {

constexpr int cube_side = 4;  // cells

/// A number for three coordinates; those of a domain's nodes differ in the lowest 21 bits.
std::uint64_t key_of(const std::array<int, 3>& at) {
  std::uint64_t key = 0;
  for (const int coordinate : at) key = key << 21 | (static_cast<std::uint64_t>(coordinate) & 0x1fffff);
  return key;
}

/// A weld joins fields wherever they meet and looks at no surface.
bool looks(const Experiment& experiment) {
  return experiment.contact && !(experiment.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION);
}

int cube_of(double x) {
  return static_cast<int>(std::floor(x / cube_side));
}

/// Calls visit for all triples from `low` to `high`, both included.
template <class Visit>
void for_each_triple(const std::array<int, 3>& low, const std::array<int, 3>& high, Visit&& visit) {
  std::array<int, 3> at{};
  for (at[0] = low[0]; at[0] <= high[0]; ++at[0])
    for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
      for (at[2] = low[2]; at[2] <= high[2]; ++at[2]) visit(at);
}

}  // namespace

ContactPoints::ContactPoints(const Experiment& experiment)
    : experiment_(experiment),
      dimension_(experiment.dimension),
      fields_(experiment.field_count),
      gives_normal_(looks(experiment) && (experiment.contact_normal->plugin->normal().traits & MPM_LOOKS_AT_POINTS)),
      sees_surfaces_(looks(experiment) &&
                     (experiment.contact_detection->plugin->detection().traits & MPM_READS_PARTICLE_SURFACES)) {
  const mpm_shape& shape = experiment.shape.plugin->shape();
  by_domain_ = shape.form == MPM_NODE_LIST;
  reach_ = by_domain_ ? shape.reach : std::max(least_reach, 0.5 * shape.width);
}

void ContactPoints::begin() {
  found_.clear(), cubes_.clear();
  places_.clear(), semi_sides_.clear();
  count_ = 0;
}

void ContactPoints::open(const std::array<int, 3>& node) {
  for (int axis = 0; axis < dimension_; ++axis) {
    const int beyond = node[axis] < 0 ? 0 : node[axis] > experiment_.grid.cells[axis] ? 1 : -1;
    if (beyond >= 0 && has_images(experiment_.faces[axis][beyond].type)) return;  // its image is what counts
  }
  if (!found_.try_emplace(key_of(node), static_cast<std::uint32_t>(count_)).second) return;
  if (count_ == nodes_.size()) nodes_.emplace_back();
  Node& opened = nodes_[count_++];
  opened.at = node;
  opened.particles.resize(static_cast<std::size_t>(fields_));
  for (auto& of_field : opened.particles) of_field.clear();
  opened.pairs.assign(pair_index(fields_ - 2, fields_ - 1, fields_) + 1, {});
  std::array<int, 3> cube{};
  for (int axis = 0; axis < dimension_; ++axis) cube[axis] = cube_of(node[axis]);
  cubes_[key_of(cube)].push_back(static_cast<std::uint32_t>(count_ - 1));
}

/// How far from a node the particles may lie that it sees, cells.
double ContactPoints::farthest_seen() const {
  return by_domain_ ? list_grid_padding : reach_;
}

bool ContactPoints::look_around(const Vector3& low, const Vector3& high) {
  window_.particles.clear();
  if (count_ == 0) return false;
  bool any = false;
  window_.near_periodic = window_.near_mirror = false;
  std::array<int, 3> first{}, last{};
  std::size_t size = 1;
  for (int axis = 0; axis < dimension_; ++axis) {
    window_.near_periodic |= near_face(axis, low[axis], high[axis], true);
    window_.near_mirror |= near_face(axis, low[axis], high[axis], false);
    window_.low[axis] = static_cast<int>(std::floor(low[axis] - farthest_seen()));
    window_.high[axis] = static_cast<int>(std::ceil(high[axis] + farthest_seen()));
    first[axis] = cube_of(window_.low[axis]), last[axis] = cube_of(window_.high[axis]);
    size *= window_.side(axis);
  }
  for_each_triple(first, last, [&](const std::array<int, 3>& cube) {
    const auto found = cubes_.find(key_of(cube));
    if (found == cubes_.end()) return;
    for (const std::uint32_t node : found->second) {
      if (!window_.holds(nodes_[node].at)) continue;
      if (!any) window_.particles.assign(size, nullptr);
      window_.particles[window_.place(nodes_[node].at)] = nodes_[node].particles.data();
      any = true;
    }
  });
  return window_.near_periodic || any;
}

/// Whether an image beyond a face of an axis may be seen of what lies between low and high.
bool ContactPoints::near_face(int axis, double low, double high, bool periodic) const {
  const auto counts = [&](int side) {
    const ConditionType type = experiment_.faces[axis][side].type;
    return has_images(type) && (type == ConditionType::periodic) == periodic;
  };
  return (counts(0) && low < farthest_seen()) || (counts(1) && high > experiment_.grid.cells[axis] - farthest_seen());
}

/// Walls that fold mirror what lies before them, as their ghosts do with the masses. Who sees a mirror image sees the
/// particle too, which is nearer. Beside a periodic face nodes are asked for by their coordinates: they may lie at either
/// end of the domain, outside the window.
void ContactPoints::add(int field, const Vector3& x, const SemiSides& semi_sides) {
  for (int axis = 0; window_.near_periodic && axis < dimension_; ++axis)
    if (near_face(axis, x[axis], x[axis], true)) return add_images(field, x, semi_sides, true);
  const auto number = static_cast<std::uint32_t>(places_.size());
  std::array<int, 3> low{}, high{};
  for (int axis = 0; axis < dimension_; ++axis) {
    const double reach = reach_of(semi_sides, axis);
    low[axis] = std::max(window_.low[axis], first_that_sees(x[axis], reach));
    high[axis] = std::min(window_.high[axis], last_that_sees(x[axis], reach));
  }
  bool seen = false;
  for (int i = low[0]; !window_.particles.empty() && i <= high[0]; ++i)
    for (int j = low[1]; j <= high[1]; ++j) {
      std::vector<std::uint32_t>** const row = window_.particles.data() + window_.place({i, j, low[2]});
      for (int k = 0; k <= high[2] - low[2]; ++k)
        if (row[k]) row[k][field].push_back(number), seen = true;
    }
  if (!seen) return;
  keep(x, semi_sides);
  for (int axis = 0; window_.near_mirror && axis < dimension_; ++axis)
    if (near_face(axis, x[axis], x[axis], false)) return add_images(field, x, semi_sides, false);
}

/// Adds the images of a particle, and itself where it is not there yet.
void ContactPoints::add_images(int field, const Vector3& x, const SemiSides& semi_sides, bool with_itself) {
  std::vector<std::pair<Vector3, SemiSides>> images{{x, semi_sides}};
  for (int axis = 0; axis < dimension_; ++axis)
    for (int side = 0; side < 2; ++side) {
      const ConditionType type = experiment_.faces[axis][side].type;
      const double wall = side ? experiment_.grid.cells[axis] : 0.0;
      if (!has_images(type) || std::abs(x[axis] - wall) >= reach_of(semi_sides, axis)) continue;
      for (std::size_t i = 0, known = images.size(); i < known; ++i) {
        auto image = images[i];
        if (image.first[axis] != x[axis]) continue;  // beyond the other wall of this axis
        if (type == ConditionType::periodic) {
          image.first[axis] += side ? -experiment_.grid.cells[axis] : experiment_.grid.cells[axis];
        } else {
          image.first[axis] = 2 * wall - x[axis];
          for (int k = 0; k < dimension_; ++k)
            image.second[3 * static_cast<std::size_t>(axis) + static_cast<std::size_t>(k)] *= -1;
        }
        images.push_back(image);
      }
    }
  for (std::size_t i = with_itself ? 0 : 1; i < images.size(); ++i) add_image(field, images[i].first, images[i].second);
}

void ContactPoints::keep(const Vector3& x, const SemiSides& semi_sides) {
  places_.push_back(x);
  if (sees_surfaces_) semi_sides_.push_back(semi_sides);
}

double ContactPoints::reach_of(const SemiSides& semi_sides, int axis) const {
  double reach = reach_;
  for (int k = 0; by_domain_ && k < dimension_; ++k)
    reach += std::abs(semi_sides[3 * static_cast<std::size_t>(axis) + static_cast<std::size_t>(k)]);
  return std::max(reach, least_reach);
}

void ContactPoints::add_image(int field, const Vector3& x, const SemiSides& semi_sides) {
  std::array<int, 3> low{}, high{};
  for (int axis = 0; axis < dimension_; ++axis) {
    const double reach = reach_of(semi_sides, axis);
    low[axis] = first_that_sees(x[axis], reach);
    high[axis] = last_that_sees(x[axis], reach);
  }
  bool kept = false;
  const auto number = static_cast<std::uint32_t>(places_.size());
  for_each_triple(low, high, [&](const std::array<int, 3>& at) {
    const auto seen_by = found_.find(key_of(at));
    if (seen_by == found_.end()) return;
    nodes_[seen_by->second].particles[static_cast<std::size_t>(field)].push_back(number);
    kept = true;
  });
  if (kept) keep(x, semi_sides);
}

double ContactPoints::half_side(double volume) const {
  return 0.5 * std::pow(volume, 1.0 / dimension_) / experiment_.grid.cell_size;
}

void ContactPoints::find(std::size_t first, std::size_t end) {
  for (std::size_t i = first; i < end; ++i)
    for (int a = 0; a < fields_; ++a)
      for (int b = a + 1; b < fields_; ++b) nodes_[i].pairs[pair_index(a, b, fields_)] = separate(nodes_[i], a, b);
}

void PointRow::take(const std::vector<Vector3>& places, const std::vector<std::uint32_t>& numbers,
                    const std::array<int, 3>& node, int dimension) {
  count = static_cast<std::uint32_t>(numbers.size());
  stride = (count + MPM_LANES - 1) / MPM_LANES * MPM_LANES;
  positions.resize(3 * static_cast<std::size_t>(stride)), weights.assign(stride, 1.0);
  double *const x = positions.data(), *const y = x + stride, *const z = y + stride;
  for (std::uint32_t i = 0; i < stride; ++i) {
    const Vector3& place = places[numbers[i < count ? i : 0]];
    x[i] = place[0] - node[0], y[i] = place[1] - node[1], z[i] = place[2] - node[2];
  }
  double* const weight = weights.data();
  for (int c = 0; c < dimension; ++c) {
    const double* const along = x + static_cast<std::size_t>(c) * stride;
    for (std::uint32_t i = 0; i < stride; ++i) weight[i] *= quadratic_weight(along[i]);
  }
  for (std::uint32_t i = count; i < stride; ++i) weight[i] = 0;
}

mpm_normal_points points_of(const PointRow& a, const PointRow& b, Vector3& normal) {
  return {a.count,          a.stride,         b.count,      b.stride, a.positions.data(), b.positions.data(),
          a.weights.data(), b.weights.data(), normal.data()};
}

SeparatedPair ContactPoints::separate(const Node& node, int a, int b) const {
  const auto particles = [&](int field) -> const std::vector<std::uint32_t>& {
    return node.particles[static_cast<std::size_t>(field)];
  };
  SeparatedPair pair;
  pair.found = !particles(a).empty() && !particles(b).empty();
  if (!pair.found || !gives_normal_) return pair;
  static thread_local PointRow of_a, of_b;  // their memory is kept from node to node
  of_a.take(places_, particles(a), node.at, dimension_), of_b.take(places_, particles(b), node.at, dimension_);
  const mpm_normal_points points = points_of(of_a, of_b, pair.normal);
  const Component& normal = *experiment_.contact_normal;
  const auto find = normal.plugin->normal().from_points[dimension_ - 2];
  pair.parted = find(normal.parameters.data(), &points) != 0;
  if (!pair.parted || !sees_surfaces_) return pair;
  const SurfacePlaces surfaces = this->surfaces(node, a, b, pair.normal);
  pair.surface_a = surfaces.of_a, pair.surface_b = surfaces.of_b;
  return pair;
}

double ContactPoints::extent(std::uint32_t particle, const Vector3& normal) const {
  return extent_along(semi_sides_[particle].data(), normal.data(), dimension_);
}

SurfacePlaces ContactPoints::surfaces(const std::array<int, 3>& at, int a, int b, const Vector3& normal) const {
  return surfaces(nodes_[found_.at(key_of(at))], a, b, normal);
}

SurfacePlaces ContactPoints::surfaces(const Node& node, int a, int b, const Vector3& normal) const {
  const auto along = [&](std::uint32_t p) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += (places_[p][c] - node.at[c]) * normal[c];
    return sum;
  };
  double surface_a = -std::numeric_limits<double>::infinity(), surface_b = std::numeric_limits<double>::infinity();
  for (const std::uint32_t p : node.particles[static_cast<std::size_t>(a)])
    surface_a = std::max(surface_a, along(p) + extent(p, normal));
  for (const std::uint32_t p : node.particles[static_cast<std::size_t>(b)])
    surface_b = std::min(surface_b, along(p) - extent(p, normal));
  return {surface_a, surface_b};
}

SeparatedPair ContactPoints::pair(const std::array<int, 3>& node, int a, int b) const {
  const auto found = found_.find(key_of(node));
  return found == found_.end() ? SeparatedPair() : nodes_[found->second].pairs[pair_index(a, b, fields_)];
}

}  // namespace mpm
