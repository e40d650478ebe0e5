#include "metrics/carried_body.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm {
namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

Vector vector_of(const std::vector<double>& values, std::size_t p, int dimension) {
  Vector v = Vector::Zero();
  for (int c = 0; c < dimension; ++c) v[c] = values[p * static_cast<std::size_t>(dimension) + c];
  return v;
}

}  // namespace

CarriedBody::CarriedBody(const BodyView& view, const Geometry& geometry)
    : geometry_(geometry), misfit_(std::numeric_limits<double>::quiet_NaN()) {
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
  cell_ = h;
  for (const SurfacePiece& piece : geometry.surface(h / 4, {experiment.grid.lower, experiment.grid.upper})) {
    const Vector from = vector(piece.point) - begin_;
    surface_.push_back({now_ + gradient * from, (inverse_.transpose() * vector(piece.normal)).normalized()});
  }
}

CarriedBody::Vector CarriedBody::slope(const Vector& x) const {
  const double step = 1e-4 * cell_;
  const Vector X = begin_ + inverse_ * (x - now_);
  Vector difference;
  for (int c = 0; c < 3; ++c) {
    const Vector aside = step * Vector::Unit(c);
    difference[c] = at_start(X + aside) - at_start(X - aside);
  }
  return inverse_.transpose() * difference / (2 * step);
}

bool CarriedBody::put_on_surface(Vector& x) const {
  constexpr int most = 60;  // Newton's steps between faces that meet come nearer by a share in each
  for (int k = 0; k < most; ++k) {
    const double outside = distance(x);
    if (std::abs(outside) < 1e-9 * cell_) return true;
    const Vector steepest = slope(x);
    const double squared = steepest.squaredNorm();
    if (!(squared > 0)) return false;
    x -= outside / squared * steepest;
  }
  return false;
}

CarriedBody::Vector CarriedBody::nearest_on_surface(const Vector& y, Vector x) const {
  if (Vector straight = y; put_on_surface(straight) && (y - straight).norm() < (y - x).norm()) x = straight;
  double share = 1;  // of the way along the surface, so that a curved one is not overshot
  for (int k = 0; k < 200 && share > 1e-6; ++k) {
    const Vector normal = outward(x), to = y - x, along = to - to.dot(normal) * normal;
    if (along.norm() < 1e-9 * cell_) break;
    Vector tried = x + share * along;
    if (put_on_surface(tried) && (y - tried).norm() < to.norm())
      x = tried, share = std::min(1.0, 1.5 * share);
    else
      share /= 2;
  }
  return x;
}

BodiesOfFields carried_bodies(Views& views) {
  const Experiment& experiment = views.experiment();
  BodiesOfFields fields(static_cast<std::size_t>(experiment.field_count));
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
    fields[static_cast<std::size_t>(experiment.bodies[body].field)].emplace_back(views.of(body),
                                                                                 *experiment.bodies[body].geometry);
  return fields;
}

}  // namespace mpm
