#include "metrics/pair_normal_error.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "simulation/contact_impulse.hpp"
#include "simulation/point_bins.hpp"

namespace mpm {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double degree = std::numbers::pi / 180;

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

Vector vector(const Vector3& v) {
  return {v[0], v[1], v[2]};
}

Vector vector_of(const std::vector<double>& values, std::size_t p, int dimension) {
  Vector v = Vector::Zero();
  for (int c = 0; c < dimension; ++c) v[c] = values[p * static_cast<std::size_t>(dimension) + c];
  return v;
}

/// A piece of a body's surface as it is now.
struct Piece {
  Vector place, normal;
};

/// A body's geometry, moved and deformed as its particles are on the whole.
class CarriedBody {
 public:
  CarriedBody(const BodyView& view, const Geometry& geometry) : geometry_(geometry) {
    const Experiment& experiment = view.experiment;
    const int D = experiment.dimension;
    const auto place = [&](std::size_t p) { return vector_of(view.state.position, p, D); };
    const auto start = [&](std::size_t p) { return vector_of(view.state.initial_position, p, D); };
    double mass = 0;
    for (std::size_t p = 0; p < view.count; ++p) {
      const double m = view.mass(p);
      mass += m, now_ += m * place(p), begin_ += m * start(p);
    }
    now_ /= mass, begin_ /= mass;
    Matrix moved = Matrix::Zero(), spread = Matrix::Zero();
    for (std::size_t p = 0; p < view.count; ++p) {
      const Vector from = start(p) - begin_;
      moved += view.mass(p) * (place(p) - now_) * from.transpose();
      spread += view.mass(p) * from * from.transpose();
    }
    if (D == 2) moved(2, 2) = spread(2, 2) = spread.trace();  // nothing moves across the plane
    const Eigen::FullPivLU<Matrix> solver(spread);
    if (!solver.isInvertible()) return;
    const Matrix gradient = moved * solver.inverse();
    if (!(gradient.determinant() > 0)) return;
    inverse_ = gradient.inverse();
    double squares = 0;
    for (std::size_t p = 0; p < view.count; ++p)
      squares += view.mass(p) * (place(p) - now_ - gradient * (start(p) - begin_)).squaredNorm();
    misfit_ = std::sqrt(squares / mass);
    const double h = experiment.grid.cell_size;
    step_ = 1e-4 * h;
    for (const SurfacePiece& piece : geometry.surface(h / 4, {experiment.grid.lower, experiment.grid.upper})) {
      const Vector from = vector(piece.point) - begin_;
      surface_.push_back({now_ + gradient * from, (inverse_.transpose() * vector(piece.normal)).normalized()});
    }
  }

  /// The root mean square distance of particles from where the map takes them, m; NaN where there is no map.
  double misfit() const { return misfit_; }
  /// Empty where there is no map.
  const std::vector<Piece>& surface() const { return surface_; }
  /// How far a place is outside of the body, in metres of the body as it began.
  double distance(const Vector& x) const { return at_start(begin_ + inverse_ * (x - now_)); }
  /// The direction in which that grows most, a unit vector; zero where there is none.
  Vector outward(const Vector& x) const {
    const Vector X = begin_ + inverse_ * (x - now_);
    Vector slope;
    for (int c = 0; c < 3; ++c) {
      const Vector aside = step_ * Vector::Unit(c);
      slope[c] = at_start(X + aside) - at_start(X - aside);
    }
    return (inverse_.transpose() * slope).stableNormalized();
  }

 private:
  double at_start(const Vector& X) const { return geometry_.distance({X[0], X[1], X[2]}); }

  const Geometry& geometry_;
  Vector now_ = Vector::Zero(), begin_ = Vector::Zero();
  Matrix inverse_ = Matrix::Identity();
  double misfit_ = nothing, step_ = 0;
  std::vector<Piece> surface_;
};

/// The bodies of each velocity field.
using BodiesOfFields = std::vector<std::vector<CarriedBody>>;

BodiesOfFields carried_bodies(Views& views) {
  const Experiment& experiment = views.experiment();
  BodiesOfFields fields(static_cast<std::size_t>(experiment.field_count));
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
    fields[static_cast<std::size_t>(experiment.bodies[body].field)].emplace_back(views.of(body),
                                                                                 *experiment.bodies[body].geometry);
  return fields;
}

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
    for (std::size_t p = 0; p < view.count; ++p)
      momentum += view.mass(p) * vector_of(view.state.velocity, p, experiment.dimension).norm();
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

PairNormalError error_of_pair(const Experiment& experiment, const std::vector<CarriedBody>& of_a,
                              const std::vector<CarriedBody>& of_b, const std::vector<LoadedNode>& nodes) {
  PairNormalError error{nothing, nothing, larger_misfit(of_a, of_b)};
  if (std::isnan(error.misfit) || nodes.empty()) return error;
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
  error.mean = sum / forces, error.largest = largest;
  return error;
}

}  // namespace

std::vector<PairNormalError> pair_normal_errors(Views& views, const std::vector<ContactNode>& nodes, double dt) {
  const Experiment& experiment = views.experiment();
  const BodiesOfFields fields = carried_bodies(views);
  const double rounding = nodes.empty() ? 0 : force_of_rounding(views, dt);
  std::vector<PairNormalError> errors;
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
      errors.push_back(
          error_of_pair(experiment, fields[static_cast<std::size_t>(a)], fields[static_cast<std::size_t>(b)], of_pair));
    }
  return errors;
}

}  // namespace mpm
