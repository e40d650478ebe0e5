#include "experiment/measure.hpp"

#include <algorithm>
#include <cmath>

namespace mpm {
namespace {

/// Cuts boxes of one region and one frame.
class Cutter {
 public:
  Cutter(const Geometry& region, int dimension, const Frame& frame, bool evenly,
         const std::function<void(const Piece&)>& visit)
      : region_(region), dimension_(dimension), frame_(frame), evenly_(evenly), visit_(visit) {}

  void cut(const Vector3& lower, const Vector3& size, int depth) const {
    Vector3 middle{};
    double volume = 1, diagonal = 0;
    for (int c = 0; c < dimension_; ++c) {
      middle[c] = lower[c] + size[c] / 2;
      volume *= size[c], diagonal += size[c] * size[c];
    }
    const double d = region_.distance(frame_.to_world(middle)), reach = std::sqrt(diagonal) / 2;
    if (d >= reach) return;
    if (d <= -reach && (!evenly_ || depth <= 0)) return visit_({middle, volume});
    if (depth > 0) return halve(lower, size, depth);
    bool bent = false;
    const Vector3 across = slope(middle, size, d, bent);
    if (bent && depth > -deeper_at_bends) return halve(lower, size, depth);
    const double share = share_behind_plane(dimension_, d, across);
    if (share > 0) visit_({middle, share * volume});
  }

 private:
  void halve(const Vector3& lower, const Vector3& size, int depth) const {
    for (int corner = 0; corner < 1 << dimension_; ++corner) {
      Vector3 from = lower, half = size;
      for (int c = 0; c < dimension_; ++c) {
        half[c] = size[c] / 2;
        if (corner >> c & 1) from[c] += half[c];
      }
      cut(from, half, depth - 1);
    }
  }

  static constexpr int deeper_at_bends = 2;  ///< edges are cut further, as a plane says little there

  /// How much the distance grows across the box along each axis, and whether the surface is bent within the box.
  Vector3 slope(const Vector3& middle, const Vector3& size, double d, bool& bent) const {
    Vector3 across{};
    for (int c = 0; c < dimension_; ++c) {
      Vector3 ahead = middle, behind = middle;
      ahead[c] += size[c] / 2, behind[c] -= size[c] / 2;
      const double far = region_.distance(frame_.to_world(ahead)), near = region_.distance(frame_.to_world(behind));
      across[c] = far - near;
      if (std::abs(far + near - 2 * d) > 0.05 * size[c]) bent = true;
    }
    return across;
  }

  const Geometry& region_;
  int dimension_;
  const Frame& frame_;
  bool evenly_;
  const std::function<void(const Piece&)>& visit_;
};

}  // namespace

double share_behind_plane(int dimension, double d, const Vector3& slope) {
  double steepest = 0, n[3] = {};
  for (int c = 0; c < dimension; ++c) steepest = std::max(steepest, n[c] = std::abs(slope[c]));
  if (steepest == 0) return d <= 0 ? 1 : 0;
  double t = -d, product = 1, factorial = 1;
  for (int c = 0; c < dimension; ++c) {
    n[c] = std::max(n[c], 1e-3 * steepest);  // a plane along an axis is tilted by as much, which keeps the sum's digits
    t += n[c] / 2;
    product *= n[c], factorial *= c + 1;
  }
  double sum = 0;
  for (int corner = 0; corner < 1 << dimension; ++corner) {
    double left = t, sign = 1;
    for (int c = 0; c < dimension; ++c)
      if (corner >> c & 1) left -= n[c], sign = -sign;
    if (left > 0) sum += sign * std::pow(left, dimension);
  }
  return std::clamp(sum / (factorial * product), 0.0, 1.0);
}

void for_each_piece(const Geometry& region, int dimension, const Frame& frame, const Vector3& lower,
                    const Vector3& upper, int depth, bool evenly, const std::function<void(const Piece&)>& visit) {
  Vector3 size{};
  for (int c = 0; c < dimension; ++c) size[c] = upper[c] - lower[c];
  Cutter(region, dimension, frame, evenly, visit).cut(lower, size, depth);
}

void Measured::add(const Measured& other) {
  volume += other.volume;
  for (int c = 0; c < 3; ++c) moment[c] += other.moment[c], second[c] += other.second[c];
  whole = false;
}

Measured measure(const Geometry& region, int dimension, const Frame& frame, const Vector3& lower, const Vector3& upper,
                 int depth) {
  Measured sum;
  double box = 1;
  for (int c = 0; c < dimension; ++c) box *= upper[c] - lower[c];
  for_each_piece(region, dimension, frame, lower, upper, depth, false, [&](const Piece& piece) {
    sum.volume += piece.volume;
    // A piece counts as a cube of its volume: what all of a box holds then has the box's own second moment.
    const double side = std::pow(piece.volume, 1.0 / dimension);
    for (int c = 0; c < dimension; ++c) {
      sum.moment[c] += piece.volume * piece.middle[c];
      sum.second[c] += piece.volume * (piece.middle[c] * piece.middle[c] + side * side / 12);
    }
  });
  sum.whole = sum.volume >= box * (1 - 1e-12);
  return sum;
}

}  // namespace mpm
