#include "simulation/separation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace mpm {
namespace {

double dot(const Vector3& u, const Vector3& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}
Vector3 difference(const Vector3& u, const Vector3& v) {
  return {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
}

constexpr std::size_t most_corners = 4;  // of a simplex in three dimensions

/// A few differences of points whose convex hull holds the shortest one found so far.
struct Simplex {
  std::array<Vector3, most_corners> corners;
  std::size_t size = 0;

  bool has(const Vector3& point) const {
    return std::find(corners.begin(), corners.begin() + size, point) != corners.begin() + size;
  }
};

/// The point nearest to the origin of the affine hull of some corners, if it lies in their convex hull.
struct Nearest {
  Vector3 point{};
  double squared = 0;
};

/// Solves the symmetric system of up to three unknowns by elimination; nothing where it is singular to rounding.
std::optional<std::array<double, 3>> solve(std::array<std::array<double, 3>, 3> m, std::array<double, 3> rhs,
                                           std::size_t n) {
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, m[i][i]);
  for (std::size_t k = 0; k < n; ++k) {
    if (m[k][k] <= 1e-13 * largest) return {};
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = m[i][k] / m[k][k];
      for (std::size_t j = k; j < n; ++j) m[i][j] -= f * m[k][j];
      rhs[i] -= f * rhs[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) rhs[k] -= m[k][j] * rhs[j];
    rhs[k] /= m[k][k];
  }
  return rhs;
}

std::optional<Nearest> nearest_of(const std::array<Vector3, most_corners>& corners, std::size_t size) {
  std::array<Vector3, 3> edges;
  std::array<std::array<double, 3>, 3> gram{};
  std::array<double, 3> rhs{};
  const std::size_t n = size - 1;
  for (std::size_t i = 0; i < n; ++i) edges[i] = difference(corners[i + 1], corners[0]);
  for (std::size_t i = 0; i < n; ++i) {
    rhs[i] = -dot(edges[i], corners[0]);
    for (std::size_t j = 0; j < n; ++j) gram[i][j] = dot(edges[i], edges[j]);
  }
  const auto share = solve(gram, rhs, n);
  if (!share) return {};
  double first = 1;
  Nearest nearest{corners[0], 0};
  for (std::size_t i = 0; i < n; ++i) {
    if ((*share)[i] < 0) return {};
    first -= (*share)[i];
    for (std::size_t c = 0; c < 3; ++c) nearest.point[c] += (*share)[i] * edges[i][c];
  }
  if (first < 0) return {};
  nearest.squared = dot(nearest.point, nearest.point);
  return nearest;
}

/// The point of a simplex nearest to the origin; the simplex keeps the corners that it lies between.
Nearest reduce(Simplex& simplex) {
  Nearest best{{}, std::numeric_limits<double>::infinity()};
  Simplex kept;
  for (unsigned chosen = 1; chosen < 1u << simplex.size; ++chosen) {
    Simplex some;
    for (std::size_t i = 0; i < simplex.size; ++i)
      if (chosen >> i & 1) some.corners[some.size++] = simplex.corners[i];
    const auto nearest = nearest_of(some.corners, some.size);
    if (nearest && nearest->squared < best.squared) best = *nearest, kept = some;
  }
  simplex = kept;
  return best;
}

/// The points of a cloud side by side, so that all are looked at in lanes. The tail repeats the first.
class Row {
 public:
  void take(const PointCloud& cloud) {
    size_ = (cloud.size() + lanes - 1) / lanes * lanes;
    values_.resize(3 * size_), places_.resize(size_);
    for (std::size_t i = 0; i < size_; ++i) {
      const Vector3& x = cloud[i < cloud.size() ? i : 0];
      for (std::size_t c = 0; c < 3; ++c) values_[c * size_ + i] = x[c];
    }
  }
  Vector3 operator[](std::size_t i) const { return {values_[i], values_[size_ + i], values_[2 * size_ + i]}; }

  /// About their middle: a first guess alone depends on it.
  Vector3 middle() const {
    Vector3 sum{};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < size_; ++i) sum[c] += values_[c * size_ + i];
    for (double& component : sum) component /= static_cast<double>(size_);
    return sum;
  }
  /// The point farthest along a direction, the first of several.
  Vector3 farthest(const Vector3& along) {
    std::array<double, lanes> most;
    most.fill(-std::numeric_limits<double>::infinity());
    const double *const x = values_.data(), *const y = x + size_, *const z = y + size_;
    for (std::size_t i = 0; i < size_; i += lanes)
      for (std::size_t k = 0; k < lanes; ++k) {
        const double at = along[0] * x[i + k] + along[1] * y[i + k] + along[2] * z[i + k];
        places_[i + k] = at;
        most[k] = at > most[k] ? at : most[k];
      }
    const double reach = *std::max_element(most.begin(), most.end());
    return (*this)[static_cast<std::size_t>(std::find(places_.begin(), places_.end(), reach) - places_.begin())];
  }

 private:
  static constexpr std::size_t lanes = 8;
  std::size_t size_ = 0;
  std::vector<double> values_, places_;
};

}  // namespace

SeparatingPlane widest_gap(const PointCloud& a, const PointCloud& b, int dimension) {
  if (a.size() == 0 || b.size() == 0) return {};
  constexpr int most_rounds = 100;
  constexpr double rounding = 1e-12;   // of the squared distance
  static thread_local Row of_a, of_b;  // their memory is kept from node to node
  of_a.take(a), of_b.take(b);
  const Vector3 apart = difference(of_b.middle(), of_a.middle());
  Simplex simplex;
  simplex.corners[simplex.size++] = difference(of_b.farthest(difference({}, apart)), of_a.farthest(apart));
  Nearest nearest{simplex.corners[0], dot(simplex.corners[0], simplex.corners[0])};
  double scale = nearest.squared;
  for (int round = 0; round < most_rounds; ++round) {
    const Vector3 next = difference(of_b.farthest(difference({}, nearest.point)), of_a.farthest(nearest.point));
    scale = std::max(scale, dot(next, next));
    if (nearest.squared <= rounding * scale) return {};  // the hulls meet
    if (nearest.squared - dot(nearest.point, next) <= rounding * nearest.squared || simplex.has(next)) break;
    if (simplex.size > static_cast<std::size_t>(dimension)) return {};  // a full simplex holds the origin
    simplex.corners[simplex.size++] = next;
    nearest = reduce(simplex);
  }
  SeparatingPlane plane{true, nearest.point, std::sqrt(nearest.squared)};
  for (double& component : plane.normal) component /= plane.gap;
  return plane;
}

}  // namespace mpm
