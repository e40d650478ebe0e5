#include "simulation/normal_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "operators/contact_geometry.hpp"
#include "simulation/contact_points.hpp"

namespace mpm {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr int flat_half = 8;       // cells along a flat face to each side that are looked at
constexpr int margin = 4;          // cells of particles beyond the nodes, more than the support of every shape
constexpr double seen_from = 1.5;  // cells: as far as ContactPoints looks around with quadratic B-splines

using Plane = std::array<double, 2>;

constexpr int nobody = -1;

/// One particle: its place, in cells, and its body.
struct Placed {
  Plane place;
  int body;
};

/// A surface: which body a place belongs to, and the normal from the first to the second.
struct Interface {
  TouchingSurface kind;
  Plane centre{}, normal{};
  double radius = 0;

  double along(const Plane& x) const { return (x[1] - centre[1]) * normal[0] - (x[0] - centre[0]) * normal[1]; }
  int body(const Plane& x) const {
    if (kind == TouchingSurface::disc) return std::hypot(x[0] - centre[0], x[1] - centre[1]) >= radius;
    const bool second = (x[0] - centre[0]) * normal[0] + (x[1] - centre[1]) * normal[1] >= 0;
    return kind == TouchingSurface::end_of_block && second && along(x) > 0 ? nobody : second;
  }
  Plane normal_at(const Plane& x) const {
    if (kind != TouchingSurface::disc) return normal;
    const double distance = std::hypot(x[0] - centre[0], x[1] - centre[1]);
    return {(x[0] - centre[0]) / distance, (x[1] - centre[1]) / distance};
  }
  bool counts(const Plane& node) const { return kind != TouchingSurface::end_of_block || std::abs(along(node)) < 2; }
};

/// A square lattice turned about the origin and shifted.
struct Lattice {
  double angle = 0;
  Plane shift{};
};

/// A number between 0 and 1 that fills the interval evenly as `place` grows: multiples of an irrational number.
double spread(int place, double irrational) {
  return std::fmod((place + 0.5) * irrational, 1.0);
}

/// The lattices of both bodies at a place. Roots of small primes are irrational to each other.
std::array<Lattice, 2> lattices_at(int place, bool turned) {
  if (!turned) return {};
  return {Lattice{90 * degree * spread(place, std::sqrt(2.0)),
                  {spread(place, std::sqrt(3.0)), spread(place, std::sqrt(5.0))}},
          Lattice{90 * degree * spread(place, std::sqrt(7.0)),
                  {spread(place, std::sqrt(11.0)), spread(place, std::sqrt(13.0))}}};
}

/// The nodes from -half to half along both axes, what the particles around give them, and the normals there.
class Patch {
 public:
  Patch(const Component& normal, const Component& shape, const TouchingBodies& bodies, const Interface& surface,
        const std::array<Lattice, 2>& lattices, int half)
      : normal_(normal), shape_(shape), bodies_(bodies), surface_(surface), half_(half), side_(2 * half + 1) {
    for (int body : {0, 1}) place(body, lattices[static_cast<std::size_t>(body)]);
    for (auto& of_body : fields_) of_body.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), {});
    for (std::size_t first = 0; first < particles_.size(); first += MPM_BATCH) scatter(first);
  }

  /// Calls visit(node, weight, normal, found) for all nodes that contact looks at; twice where each body has its own.
  template <class Visit>
  void for_each_normal(Visit&& visit) const {
    for (int i = -half_; i <= half_; ++i)
      for (int j = -half_; j <= half_; ++j) {
        const ContactFieldNode &a = fields_[0][at(i, j)], &b = fields_[1][at(i, j)];
        if (!meet(a.mass, b.mass, /*weld=*/false)) continue;
        const Plane node{static_cast<double>(i), static_cast<double>(j)};
        if (!surface_.counts(node)) continue;
        const double of_a = a.mass, of_b = b.mass / bodies_.density_ratio;  // volumes
        const double weight = of_a * of_b / (of_a + of_b);
        if (normal_.plugin->normal().traits & MPM_LOOKS_AT_POINTS)
          by_points({i, j, 0}, a, b, [&](const Plane& n, bool found) { visit(node, weight, n, found); });
        else
          by_sums(a, b, [&](const Plane& n, bool found) { visit(node, weight, n, found); });
      }
  }

 private:
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(i + half_) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(j + half_);
  }

  /// Places a body's particles on its lattice, where it is.
  void place(int body, const Lattice& lattice) {
    const int n = bodies_.particles_per_cell_axis, reach = half_ + margin, most = 2 * reach * n;
    const double c = std::cos(lattice.angle), s = std::sin(lattice.angle);
    for (int i = -most; i < most; ++i)
      for (int j = -most; j < most; ++j) {
        const double u = (i + 0.5 + lattice.shift[0]) / n, v = (j + 0.5 + lattice.shift[1]) / n;
        const Plane x{c * u - s * v, s * u + c * v};
        if (std::max(std::abs(x[0]), std::abs(x[1])) < reach && surface_.body(x) == body)
          particles_.push_back({x, body});
      }
  }

  /// Adds what a batch of particles gives to the nodes, by the shape's own weights.
  void scatter(std::size_t first) {
    const mpm_shape& shape = shape_.plugin->shape();
    constexpr std::size_t n = MPM_BATCH;
    const double half_side = 0.5 / bodies_.particles_per_cell_axis;
    std::array<double, 2 * n> position, half_size, offset;
    std::array<double, 4 * n> domain{};
    std::vector<double> weight(2 * shape.width * n), gradient(2 * shape.width * n);
    std::array<std::int32_t, 2 * n> base;
    const std::size_t count = std::min(n, particles_.size() - first);
    half_size.fill(half_side);
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t c = 0; c < 2; ++c) {
        position[c * n + p] = particles_[first + std::min(p, count - 1)].place[c];
        domain[3 * c * n + p] = half_side;
      }
    mpm_shape_batch batch{};
    batch.count = batch.stride = n, batch.dimension = 2;
    batch.position = position.data(), batch.half_size = half_size.data(), batch.domain = domain.data();
    batch.base = base.data(), batch.offset = offset.data();
    batch.weight = weight.data(), batch.gradient = gradient.data();
    shape.evaluate[MPM_SCALAR_DOUBLE](shape_.parameters.data(), &batch);
    const double volume = 1.0 / (bodies_.particles_per_cell_axis * bodies_.particles_per_cell_axis);
    for (std::size_t p = 0; p < count; ++p)
      for (std::uint32_t i = 0; i < shape.width; ++i)
        for (std::uint32_t j = 0; j < shape.width; ++j) {
          const int x = base[p] + static_cast<int>(i), y = base[n + p] + static_cast<int>(j);
          if (std::max(std::abs(x), std::abs(y)) > half_) continue;
          const std::size_t along_x = i * n + p, along_y = (shape.width + j) * n + p;
          add(particles_[first + p], at(x, y), volume, weight[along_x] * weight[along_y],
              {gradient[along_x] * weight[along_y], weight[along_x] * gradient[along_y]});
        }
  }
  void add(const Placed& particle, std::size_t node, double volume, double weight, const Plane& gradient) {
    ContactFieldNode& field = fields_[static_cast<std::size_t>(particle.body)][node];
    const double density = particle.body ? bodies_.density_ratio : 1;
    field.mass += density * volume * weight;
    for (std::size_t c = 0; c < 2; ++c) {
      field.volume_gradient[c] += volume * gradient[c];
      field.mass_gradient[c] += density * volume * gradient[c];
    }
  }

  template <class Give>
  void by_sums(const ContactFieldNode& a, const ContactFieldNode& b, Give&& give) const {
    const mpm_normal& functions = normal_.plugin->normal();
    constexpr std::size_t n = MPM_LANES;
    std::array<std::array<double, 2 * n>, 4> given{};
    std::array<std::array<double, 2 * n>, 3> out{};
    std::array<std::int32_t, n> found{};
    const double* const sums[] = {a.mass_gradient, b.mass_gradient, a.volume_gradient, b.volume_gradient};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t c = 0; c < 2; ++c) std::fill_n(given[k].begin() + c * n, n, sums[k][c]);
    const mpm_normal_batch batch{n,
                                 n,
                                 2,
                                 0,
                                 given[0].data(),
                                 given[1].data(),
                                 given[2].data(),
                                 given[3].data(),
                                 out[0].data(),
                                 out[1].data(),
                                 out[2].data(),
                                 found.data()};
    functions.from_sums[MPM_SCALAR_DOUBLE][0](normal_.parameters.data(), &batch);
    const auto of = [&](std::size_t k) { return Plane{out[k][0], out[k][n]}; };
    if (!(functions.traits & MPM_OWN_NORMALS)) return give(of(0), found[0] != 0);
    give(of(1), found[0] != 0);
    give(of(2), found[0] != 0);
  }

  template <class Give>
  void by_points(const std::array<int, 3>& node, const ContactFieldNode& a, const ContactFieldNode& b,
                 Give&& give) const {
    std::vector<Vector3> places;
    std::array<std::vector<std::uint32_t>, 2> of_body;
    for (const Placed& particle : particles_) {
      if (std::abs(particle.place[0] - node[0]) >= seen_from || std::abs(particle.place[1] - node[1]) >= seen_from)
        continue;
      of_body[static_cast<std::size_t>(particle.body)].push_back(static_cast<std::uint32_t>(places.size()));
      places.push_back({particle.place[0], particle.place[1], 0});
    }
    Vector3 normal{};
    bool found = !of_body[0].empty() && !of_body[1].empty();
    if (found) {
      PointRow row_a, row_b;
      row_a.take(places, of_body[0], node, 2), row_b.take(places, of_body[1], node, 2);
      const mpm_normal_points points = points_of(row_a, row_b, normal);
      found = normal_.plugin->normal().from_points[0](normal_.parameters.data(), &points) != 0 ||
              average_gradient(a, b, 2, normal.data());
    }
    give({normal[0], normal[1]}, found);
  }

  const Component &normal_, &shape_;
  const TouchingBodies& bodies_;
  const Interface& surface_;
  const int half_, side_;
  std::vector<Placed> particles_;
  std::array<std::vector<ContactFieldNode>, 2> fields_;  ///< [body][node]
};

/// The angle between a direction and the nearest axis, degrees, 0 to 45.
double angle_to_axes(const Plane& direction) {
  const double x = std::abs(direction[0]), y = std::abs(direction[1]);
  return std::atan2(std::min(x, y), std::max(x, y)) / degree;
}

void add_error(NormalErrors& errors, double weight, const Plane& found, const Plane& exact) {
  const double across = found[0] * exact[1] - found[1] * exact[0], along = found[0] * exact[0] + found[1] * exact[1];
  const double error = std::abs(std::atan2(across, along)) / degree;
  errors.rms += weight * error * error, errors.weight += weight;
  errors.largest = std::max(errors.largest, error);
  ++errors.nodes;
}

void check(const Component& shape, const TouchingBodies& bodies, int places) {
  if (shape.plugin->shape().form == MPM_NODE_LIST)
    throw std::invalid_argument("the nodes of " + std::string(shape.plugin->id()) +
                                " follow no axes: shapes that are tensor products alone");
  if (bodies.particles_per_cell_axis < 1 || places < 1)
    throw std::invalid_argument("there must be one particle a cell and axis, and one place, or more");
  if (!(bodies.density_ratio > 0) || !(bodies.radius > 0))
    throw std::invalid_argument("the ratio of densities and the radius must be above 0");
}

}  // namespace

std::vector<NormalErrors> normal_errors(const Component& normal, const Component& shape, const TouchingBodies& bodies,
                                        const std::vector<double>& angles, int places) {
  check(shape, bodies, places);
  std::vector<NormalErrors> all(angles.size());
  for (std::size_t k = 0; k < angles.size(); ++k) all[k].angle = angles[k];
  const auto nearest = [&](double angle) -> NormalErrors& {
    return *std::min_element(all.begin(), all.end(), [&](const NormalErrors& one, const NormalErrors& other) {
      return std::abs(one.angle - angle) < std::abs(other.angle - angle);
    });
  };
  const bool disc = bodies.surface == TouchingSurface::disc;
  const auto look = [&](const Interface& surface, int place, int half, NormalErrors* one) {
    Patch(normal, shape, bodies, surface, lattices_at(place, bodies.turned), half)
        .for_each_normal([&](const Plane& node, double weight, const Plane& n, bool found) {
          const Plane exact = surface.normal_at(node);
          NormalErrors& errors = one ? *one : nearest(angle_to_axes(exact));
          found ? add_error(errors, weight, n, exact) : void(++errors.without);
        });
  };
  for (int place = 0; place < places; ++place) {
    const double across = (place + 0.5) / places - 0.5, aside = spread(place, std::numbers::phi) - 0.5;
    if (disc) {
      const Interface rim{bodies.surface, {across, aside}, {}, bodies.radius};
      look(rim, place, static_cast<int>(std::ceil(bodies.radius)) + 3, nullptr);
      continue;
    }
    for (NormalErrors& errors : all) {
      const Plane n{std::cos(errors.angle * degree), std::sin(errors.angle * degree)};
      look({bodies.surface, {across * n[0] - aside * n[1], across * n[1] + aside * n[0]}, n, 0}, place, flat_half,
           &errors);
    }
  }
  for (NormalErrors& errors : all)
    if (errors.nodes > 0) errors.rms = std::sqrt(errors.rms / errors.weight);
  return all;
}

}  // namespace mpm
