#pragma once
// Bodies whose geometry is known, moved and deformed as their particles are on the whole.

#include <Eigen/Core>
#include <vector>

#include "metrics/probes.hpp"

namespace mpm {

inline Eigen::Vector3d vector(const Vector3& v) {
  return {v[0], v[1], v[2]};
}

/// A body's geometry under the affine map that fits the places of its particles best, by their masses. Bodies that move as
/// a rigid or an affine body are known to rounding; `misfit` tells how far the others are from it.
class CarriedBody {
 public:
  using Vector = Eigen::Vector3d;
  /// A piece of the surface as it is now.
  struct Piece {
    Vector place, normal;
  };

  CarriedBody(const BodyView& view, const Geometry& geometry);

  /// The root mean square distance of particles from where the map takes them, m; NaN where there is no map.
  double misfit() const { return misfit_; }
  /// Pieces of a quarter of a cell; none where there is no map.
  const std::vector<Piece>& surface() const { return surface_; }
  /// How far a place is outside of the body, in metres of the body as it began: less than zero inside.
  double distance(const Vector& x) const { return at_start(begin_ + inverse_ * (x - now_)); }
  /// The direction in which that grows most, a unit vector; zero where there is none.
  Vector outward(const Vector& x) const { return slope(x).stableNormalized(); }
  /// Takes a place near the surface onto it; false where it does not come to lie on it to 1e-9 cells.
  bool put_on_surface(Vector& x) const;
  /// The place of the surface that is nearest to y, sought from a place on it: the distance falls all the way.
  Vector nearest_on_surface(const Vector& y, Vector x) const;

 private:
  double at_start(const Vector& X) const { return geometry_.distance({X[0], X[1], X[2]}); }
  /// How that distance changes from place to place, metres of the beginning per metre of now.
  Vector slope(const Vector& x) const;

  const Geometry& geometry_;
  Vector now_ = Vector::Zero(), begin_ = Vector::Zero();
  Eigen::Matrix3d inverse_ = Eigen::Matrix3d::Identity();
  double misfit_, cell_ = 0;  ///< m
  std::vector<Piece> surface_;
};

/// The bodies of each velocity field.
using BodiesOfFields = std::vector<std::vector<CarriedBody>>;
BodiesOfFields carried_bodies(Views& views);

}  // namespace mpm
