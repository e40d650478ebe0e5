#include "metrics/pair_surfaces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "metrics/carried_body.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/point_bins.hpp"

namespace mpm {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double degree = std::numbers::pi / 180;

using Vector = CarriedBody::Vector;
using Piece = CarriedBody::Piece;

Vector3 vector3(const Vector& v) {
  return {v[0], v[1], v[2]};
}

/// The pieces of the surfaces of one field that face a body of another and are within `reach` of it, metres, and near one
/// of some places: at the edge of a face the one beside it does not count, which leads away from the other body.
PointBins<Piece> facing(const std::vector<CarriedBody>& field, const std::vector<CarriedBody>& other, double reach,
                        const std::vector<Vector>& places, int dimension) {
  const double half_right_angle = std::sqrt(0.5);
  PointBins<Piece> pieces(dimension, reach);
  for (const Vector& place : places) pieces.open_around(vector3(place));
  const auto faces = [&](const Piece& piece) {
    return std::any_of(other.begin(), other.end(), [&](const CarriedBody& met) {
      return std::abs(met.distance(piece.place)) < reach &&
             piece.normal.dot(met.outward(piece.place)) < -half_right_angle;
    });
  };
  for (const CarriedBody& body : field)
    for (const Piece& piece : body.surface())
      if (pieces.is_open(vector3(piece.place)) && faces(piece)) pieces.add(vector3(piece.place), piece);
  return pieces;
}

/// The angle between a unit vector and the normal of the piece that is nearest to a place, degrees; infinite without
/// pieces.
double angle_to_nearest(const PointBins<Piece>& pieces, const Vector& x, const Vector& direction) {
  double least = std::numeric_limits<double>::infinity(), angle = least;
  pieces.for_each_near(vector3(x), [&](const Piece& piece) {
    const double squared = (piece.place - x).squaredNorm();
    if (!(squared < least)) return;
    least = squared;
    angle = std::atan2(direction.cross(piece.normal).norm(), direction.dot(piece.normal)) / degree;
  });
  return angle;
}

/// The force that rounding may give the nodes of a scene, N: a few units in the last place of what moves.
double force_of_rounding(Views& views, double dt) {
  const Experiment& experiment = views.experiment();
  const double epsilon = experiment.precision == Precision::single ? std::numeric_limits<float>::epsilon()
                                                                   : std::numeric_limits<double>::epsilon();
  double momentum = 0;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyView& view = views.of(body);
    const auto D = static_cast<std::size_t>(experiment.dimension);
    for (std::size_t p = 0; p < view.count; ++p) {
      double squared = 0;
      for (std::size_t c = 0; c < D; ++c) squared += view.state.velocity[p * D + c] * view.state.velocity[p * D + c];
      momentum += view.mass(p) * std::sqrt(squared);
    }
  }
  return 8 * epsilon * momentum / dt;
}

/// The larger misfit of two fields; NaN where one is not known.
double larger_misfit(const std::vector<CarriedBody>& a, const std::vector<CarriedBody>& b) {
  double largest = 0;
  for (const std::vector<CarriedBody>* field : {&a, &b})
    for (const CarriedBody& body : *field) largest = largest_of(largest, body.misfit());
  return largest;
}

/// A node of a pair that has a force.
struct LoadedNode {
  Vector place, normal;
  double force;  ///< N
};

/// The smallest distance of two bodies, m; less than zero by the deepest piece where one lies inside the other.
double gap_between(const CarriedBody& a, const CarriedBody& b, double cell_size) {
  if (a.surface().empty() || b.surface().empty()) return nothing;
  double nearest = std::numeric_limits<double>::infinity();
  Vector place = Vector::Zero();
  const CarriedBody* body = &a;  // whose surface the place is on
  for (const auto& [one, other] : {std::pair{&a, &b}, std::pair{&b, &a}})
    for (const Piece& piece : one->surface()) {
      const double distance = other->distance(piece.place);
      if (distance < nearest) nearest = distance, place = piece.place, body = one;
    }
  if (!(nearest > 0)) return nearest;
  // The nearest places lie between the middles of pieces: going from one surface to the other and back leads there.
  const CarriedBody* const other = body == &a ? &b : &a;
  const Vector begin = place;
  const auto nearer = [&](const Piece& one, const Piece& two) {
    return (one.place - begin).squaredNorm() < (two.place - begin).squaredNorm();
  };
  Vector x = begin, y = std::min_element(other->surface().begin(), other->surface().end(), nearer)->place;
  double gap = (y - x).norm();
  for (int k = 0; k < 100; ++k) {
    const double before = gap;
    y = other->nearest_on_surface(x, y);
    x = body->nearest_on_surface(y, x);
    gap = (y - x).norm();
    if (!(gap < before - 1e-9 * cell_size)) break;
  }
  // Surfaces that cross between the middles of pieces touch, but for rounding.
  return gap > 1e-7 * cell_size ? gap : 0;
}

/// The smallest gap of the bodies of two fields; NaN where one is not known.
double smallest_gap(const std::vector<CarriedBody>& of_a, const std::vector<CarriedBody>& of_b, double cell_size) {
  double gap = std::numeric_limits<double>::infinity();
  for (const CarriedBody& a : of_a)
    for (const CarriedBody& b : of_b) gap = std::min(gap, gap_between(a, b, cell_size));
  return gap;
}

PairSurfaces surfaces_of_pair(const Experiment& experiment, const std::vector<CarriedBody>& of_a,
                              const std::vector<CarriedBody>& of_b, const std::vector<LoadedNode>& nodes) {
  PairSurfaces error{nothing, nothing, larger_misfit(of_a, of_b), nothing};
  if (std::isnan(error.misfit)) return error;
  error.gap = smallest_gap(of_a, of_b, experiment.grid.cell_size);
  if (nodes.empty()) return error;
  std::vector<Vector> places;
  double largest_force = 0;
  for (const LoadedNode& node : nodes)
    places.push_back(node.place), largest_force = std::max(largest_force, node.force);
  const double reach = 2 * experiment.grid.cell_size;
  const PointBins<Piece> pieces_of_a = facing(of_a, of_b, reach, places, experiment.dimension),
                         pieces_of_b = facing(of_b, of_a, reach, places, experiment.dimension);
  double sum = 0, forces = 0, largest = 0;
  for (const LoadedNode& node : nodes) {
    const double angle = std::min(angle_to_nearest(pieces_of_a, node.place, node.normal),
                                  angle_to_nearest(pieces_of_b, node.place, -node.normal));
    if (!std::isfinite(angle)) return error;  // nothing near the node faces the other body
    sum += node.force * angle, forces += node.force;
    if (node.force >= 0.01 * largest_force) largest = std::max(largest, angle);
  }
  error.normal_error = sum / forces, error.largest_normal_error = largest;
  return error;
}

}  // namespace

std::vector<PairSurfaces> pair_surfaces(Views& views, const std::vector<ContactNode>& nodes, double dt) {
  const Experiment& experiment = views.experiment();
  const BodiesOfFields fields = carried_bodies(views);
  const double rounding = nodes.empty() ? 0 : force_of_rounding(views, dt);
  std::vector<PairSurfaces> pairs;
  for (int a = 0; a < experiment.field_count; ++a)
    for (int b = a + 1; b < experiment.field_count; ++b) {
      std::vector<LoadedNode> of_pair;
      for (const ContactNode& node : nodes) {
        const double force = vector(node.force).norm();
        if (node.a != a || node.b != b || !(force > rounding)) continue;
        Vector x = Vector::Zero();
        for (int c = 0; c < experiment.dimension; ++c)
          x[c] = experiment.grid.lower[c] + experiment.grid.cell_size * node.node[static_cast<std::size_t>(c)];
        of_pair.push_back({x, vector(node.normal), force});
      }
      const auto &of_a = fields[static_cast<std::size_t>(a)], &of_b = fields[static_cast<std::size_t>(b)];
      pairs.push_back(surfaces_of_pair(experiment, of_a, of_b, of_pair));
    }
  return pairs;
}

}  // namespace mpm
