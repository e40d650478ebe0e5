#include "experiment/geometry.hpp"

#include "support/numbers.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace mpm {
namespace {

using support::infinity;

double squared_distance(int dimension, const Vector3& a, const Vector3& b) {
  double sum = 0;
  for (int i = 0; i < dimension; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

std::pair<double, double> about_centre(double centre, double half) {
  return {centre - half, centre + half};
}

/// The distance from a box of a point at `beyond` its faces, along each axis the farther one's, negative inside.
double distance_from_box(int dimension, const Vector3& beyond) {
  double outside = 0, inside = -infinity;
  for (int i = 0; i < dimension; ++i) {
    outside += std::max(beyond[i], 0.0) * std::max(beyond[i], 0.0);
    inside = std::max(inside, beyond[i]);
  }
  return inside > 0 ? std::sqrt(outside) : inside;
}

std::pair<Vector3, Vector3> box_around(int dimension, const Vector3& centre, const Vector3& half) {
  std::pair<Vector3, Vector3> box{};
  for (int i = 0; i < dimension; ++i) {
    box.first[i] = centre[i] - half[i];
    box.second[i] = centre[i] + half[i];
  }
  return box;
}

class Ball final : public Geometry {
 public:
  Ball(int dimension, const Vector3& centre, double radius) : dimension_(dimension), centre_(centre), radius_(radius) {}
  bool contains(const Vector3& point) const override {
    return squared_distance(dimension_, point, centre_) <= radius_ * radius_;
  }
  std::pair<Vector3, Vector3> bounds() const override {
    return box_around(dimension_, centre_, {radius_, radius_, radius_});
  }
  double distance(const Vector3& point) const override {
    return std::sqrt(squared_distance(dimension_, point, centre_)) - radius_;
  }
  std::pair<double, double> extent(const Vector3& direction) const override {
    return about_centre(dot(direction, centre_), radius_);
  }
  double smallest_radius() const override { return radius_; }
  Surface surface(double spacing, const std::pair<Vector3, Vector3>&) const override {
    Surface pieces;
    dimension_ == 2 ? add_circle(pieces, centre_, radius_, 1, spacing) : add_sphere(pieces, centre_, radius_, spacing);
    return pieces;
  }

 private:
  int dimension_;
  Vector3 centre_;
  double radius_;
};

class Box final : public Geometry {
 public:
  Box(int dimension, const Vector3& lower, const Vector3& upper)
      : dimension_(dimension), lower_(lower), upper_(upper) {}
  bool contains(const Vector3& point) const override {
    for (int i = 0; i < dimension_; ++i) {
      if (point[i] < lower_[i] || point[i] > upper_[i]) return false;
    }
    return true;
  }
  std::pair<Vector3, Vector3> bounds() const override { return {lower_, upper_}; }
  Surface surface(double spacing, const std::pair<Vector3, Vector3>&) const override {
    Surface pieces;
    add_box(pieces, dimension_, lower_, upper_, spacing);
    return pieces;
  }
  double distance(const Vector3& point) const override {
    Vector3 beyond{};
    for (int i = 0; i < dimension_; ++i) beyond[i] = std::max(lower_[i] - point[i], point[i] - upper_[i]);
    return distance_from_box(dimension_, beyond);
  }
  std::pair<double, double> extent(const Vector3& direction) const override {
    std::pair<double, double> ends{0, 0};
    for (int i = 0; i < dimension_; ++i) {
      const double a = direction[i] * lower_[i], b = direction[i] * upper_[i];
      ends.first += std::min(a, b), ends.second += std::max(a, b);
    }
    return ends;
  }
  Frame frame() const override {
    Frame frame;
    frame.filled = true, frame.lower = lower_, frame.upper = upper_;
    return frame;
  }

 private:
  int dimension_;
  Vector3 lower_, upper_;
};

class Ring final : public Geometry {
 public:
  Ring(int dimension, const Vector3& centre, double inner, double outer, int axis, double length)
      : dimension_(dimension),
        axis_(dimension == 2 ? 2 : axis),
        centre_(centre),
        inner_(inner),
        outer_(outer),
        length_(length) {}
  bool contains(const Vector3& point) const override {
    double across = 0;
    for (int i = 0; i < dimension_; ++i) {
      if (i != axis_) across += (point[i] - centre_[i]) * (point[i] - centre_[i]);
    }
    if (across < inner_ * inner_ || across > outer_ * outer_) return false;
    return dimension_ == 2 || std::abs(point[axis_] - centre_[axis_]) <= length_ / 2;
  }
  std::pair<Vector3, Vector3> bounds() const override {
    Vector3 half{outer_, outer_, outer_};
    half[axis_] = length_ / 2;
    return box_around(dimension_, centre_, half);
  }
  double distance(const Vector3& point) const override {
    double across = 0;
    for (int i = 0; i < dimension_; ++i)
      if (i != axis_) across += (point[i] - centre_[i]) * (point[i] - centre_[i]);
    const double radius = std::sqrt(across);
    const double beyond = inner_ > 0 ? std::max(inner_ - radius, radius - outer_) : radius - outer_;
    if (dimension_ == 2) return beyond;
    return distance_from_box(2, {beyond, std::abs(point[axis_] - centre_[axis_]) - length_ / 2, 0});
  }
  std::pair<double, double> extent(const Vector3& direction) const override {
    const double along = dimension_ == 2 ? 0 : std::abs(direction[axis_]);
    return about_centre(dot(direction, centre_),
                        outer_ * std::sqrt(std::max(0.0, 1 - along * along)) + length_ / 2 * along);
  }
  double smallest_radius() const override { return inner_ > 0 ? inner_ : outer_; }
  Surface surface(double spacing, const std::pair<Vector3, Vector3>&) const override {
    Surface pieces;
    for (const auto& [radius, side] : {std::pair{inner_, -1}, std::pair{outer_, 1}}) {
      if (radius == 0) continue;
      dimension_ == 2 ? add_circle(pieces, centre_, radius, side, spacing)
                      : add_cylinder(pieces, centre_, radius, axis_, length_, side, spacing);
    }
    for (const int end : {-1, 1})
      if (dimension_ == 3) add_cap(pieces, centre_, inner_, outer_, axis_, length_, end, spacing);
    return pieces;
  }

 private:
  int dimension_, axis_;
  Vector3 centre_;
  double inner_, outer_, length_;
};

class Polygon final : public Geometry {
 public:
  explicit Polygon(std::vector<Vector3> points) : points_(std::move(points)) {}
  bool contains(const Vector3& p) const override {
    bool inside = false;
    for (std::size_t i = 0, j = points_.size() - 1; i < points_.size(); j = i++) {
      const Vector3 &a = points_[i], &b = points_[j];
      if (on_edge(p, a, b)) return true;
      const bool straddles = (a[1] > p[1]) != (b[1] > p[1]);
      if (straddles && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]) inside = !inside;
    }
    return inside;
  }
  std::pair<Vector3, Vector3> bounds() const override {
    std::pair<Vector3, Vector3> box{{infinity, infinity, 0}, {-infinity, -infinity, 0}};
    for (const Vector3& point : points_) {
      for (int i = 0; i < 2; ++i) {
        box.first[i] = std::min(box.first[i], point[i]);
        box.second[i] = std::max(box.second[i], point[i]);
      }
    }
    return box;
  }
  Surface surface(double spacing, const std::pair<Vector3, Vector3>&) const override {
    Surface pieces;
    const int turn = polygon_area(points_) > 0 ? 1 : -1;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vector3 &a = points_[i], &b = points_[(i + 1) % points_.size()];
      const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
      if (length > 0)
        add_edge(pieces, a, b, {turn * (b[1] - a[1]) / length, -turn * (b[0] - a[0]) / length, 0}, spacing);
    }
    return pieces;
  }
  double distance(const Vector3& p) const override {
    double squared = infinity;
    for (std::size_t i = 0, j = points_.size() - 1; i < points_.size(); j = i++) {
      const Vector3 &a = points_[j], &b = points_[i];
      const double ex = b[0] - a[0], ey = b[1] - a[1], px = p[0] - a[0], py = p[1] - a[1];
      const double length = ex * ex + ey * ey;
      const double along = length > 0 ? std::clamp((px * ex + py * ey) / length, 0.0, 1.0) : 0;
      squared = std::min(squared, std::pow(px - along * ex, 2) + std::pow(py - along * ey, 2));
    }
    return contains(p) ? -std::sqrt(squared) : std::sqrt(squared);
  }
  std::pair<double, double> extent(const Vector3& direction) const override {
    std::pair<double, double> ends{infinity, -infinity};
    for (const Vector3& point : points_) {
      const double along = direction[0] * point[0] + direction[1] * point[1];
      ends = {std::min(ends.first, along), std::max(ends.second, along)};
    }
    return ends;
  }

 private:
  static bool on_edge(const Vector3& p, const Vector3& a, const Vector3& b) {
    const double cross = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    const double along = (p[0] - a[0]) * (p[0] - b[0]) + (p[1] - a[1]) * (p[1] - b[1]);
    return cross == 0 && along <= 0;
  }

  std::vector<Vector3> points_;
};

/// A body that has no particles of its own at the start fills none.
class Nothing final : public Geometry {
 public:
  explicit Nothing(const Vector3& point) : point_(point) {}
  bool contains(const Vector3&) const override { return false; }
  std::pair<Vector3, Vector3> bounds() const override { return {point_, point_}; }
  double distance(const Vector3&) const override { return infinity; }
  std::pair<double, double> extent(const Vector3& direction) const override {
    const double at = dot(direction, point_);
    return {at, at};
  }
  Surface surface(double, const std::pair<Vector3, Vector3>&) const override { return {}; }

 private:
  Vector3 point_;
};

class HalfSpace final : public Geometry {
 public:
  HalfSpace(int dimension, const Vector3& point, const Vector3& normal)
      : dimension_(dimension), point_(point), normal_(normal) {}
  bool contains(const Vector3& p) const override {
    double height = 0;
    for (int i = 0; i < dimension_; ++i) height += (p[i] - point_[i]) * normal_[i];
    return height <= 0;
  }
  std::pair<Vector3, Vector3> bounds() const override {
    std::pair<Vector3, Vector3> box{};
    int axes = 0, last = 0;
    for (int i = 0; i < dimension_; ++i) {
      box.first[i] = -infinity;
      box.second[i] = infinity;
      if (normal_[i] != 0) ++axes, last = i;
    }
    // A plane across one axis bounds that axis on one side.
    if (axes == 1) (normal_[last] > 0 ? box.second : box.first)[last] = point_[last];
    return box;
  }
  double distance(const Vector3& p) const override {
    double height = 0;
    for (int i = 0; i < dimension_; ++i) height += (p[i] - point_[i]) * normal_[i];
    return height / length();
  }
  std::pair<double, double> extent(const Vector3& direction) const override {
    double along = 0, foot = 0;
    for (int i = 0; i < dimension_; ++i) along += direction[i] * normal_[i], foot += direction[i] * point_[i];
    const double cosine = along / length();
    if (std::abs(cosine) < 1 - 1e-12) return {-infinity, infinity};
    return cosine > 0 ? std::pair(-infinity, foot) : std::pair(foot, infinity);
  }
  /// Rows lie along the plane, the first one half a spacing below it.
  Frame frame() const override;
  Surface surface(double spacing, const std::pair<Vector3, Vector3>& within) const override {
    Surface pieces;
    add_plane(pieces, dimension_, point_, normal_, within.first, within.second, spacing);
    return pieces;
  }

 private:
  double length() const {
    double sum = 0;
    for (int i = 0; i < dimension_; ++i) sum += normal_[i] * normal_[i];
    return std::sqrt(sum);
  }

  int dimension_;
  Vector3 point_, normal_;
};

Frame HalfSpace::frame() const {
  Frame frame;
  Vector3 up{};
  for (int i = 0; i < dimension_; ++i) up[i] = normal_[i] / length();
  frame.origin = point_;
  if (dimension_ == 2) {
    frame.axes = {{{up[1], -up[0], 0}, up, {0, 0, 1}}};
    return frame;
  }
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto least = std::min_element(up.begin(), up.end(), smaller) - up.begin();
  Vector3 first{};
  for (int i = 0; i < 3; ++i) first[i] = (i == least ? 1 : 0) - up[least] * up[i];
  const double norm = std::sqrt(dot(first, first));
  for (double& x : first) x /= norm;
  frame.axes = {
      {first,
       {up[1] * first[2] - up[2] * first[1], up[2] * first[0] - up[0] * first[2], up[0] * first[1] - up[1] * first[0]},
       up}};
  return frame;
}

/// Twice the signed area of the triangle a b c.
double turn(const Vector3& a, const Vector3& b, const Vector3& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool within(const Vector3& a, const Vector3& b, const Vector3& p) {
  return std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= p[1] &&
         p[1] <= std::max(a[1], b[1]);
}

bool segments_meet(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0)) && abc != 0 && abd != 0 && cda != 0 && cdb != 0) return true;
  return (abc == 0 && within(a, b, c)) || (abd == 0 && within(a, b, d)) || (cda == 0 && within(c, d, a)) ||
         (cdb == 0 && within(c, d, b));
}

/// Whether b-c folds back on a-b. Neighbouring edges share b; they are at fault only then.
bool folds_back(const Vector3& a, const Vector3& b, const Vector3& c) {
  const double along = (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]);
  return turn(a, b, c) == 0 && along >= 0;
}

}  // namespace

Vector3 Frame::to_world(const Vector3& local) const {
  Vector3 point = origin;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) point[i] += axes[k][i] * local[k];
  return point;
}

Vector3 Frame::to_local(const Vector3& point) const {
  Vector3 local{};
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) local[k] += axes[k][i] * (point[i] - origin[i]);
  return local;
}

Vector3 middle_of(const Geometry& geometry) {
  const auto [lower, upper] = geometry.bounds();
  Vector3 middle{};
  for (int i = 0; i < 3; ++i)
    if (std::isfinite(lower[i]) && std::isfinite(upper[i])) middle[i] = (lower[i] + upper[i]) / 2;
  return middle;
}

Frame Geometry::frame() const {
  Frame frame;
  frame.origin = middle_of(*this);
  return frame;
}

GeometryPointer make_ball(int dimension, const Vector3& centre, double radius) {
  return std::make_shared<Ball>(dimension, centre, radius);
}
GeometryPointer make_box(int dimension, const Vector3& lower, const Vector3& upper) {
  return std::make_shared<Box>(dimension, lower, upper);
}
GeometryPointer make_ring(int dimension, const Vector3& centre, double inner, double outer, int axis, double length) {
  return std::make_shared<Ring>(dimension, centre, inner, outer, axis, length);
}
GeometryPointer make_polygon(std::vector<Vector3> points) {
  return std::make_shared<Polygon>(std::move(points));
}
GeometryPointer make_nothing(const Vector3& point) {
  return std::make_shared<Nothing>(point);
}
GeometryPointer make_half_space(int dimension, const Vector3& point, const Vector3& normal) {
  return std::make_shared<HalfSpace>(dimension, point, normal);
}
double polygon_area(const std::vector<Vector3>& points) {
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3 &a = points[i], &b = points[(i + 1) % points.size()];
    area += (a[0] * b[1] - a[1] * b[0]) / 2;
  }
  return area;
}

std::pair<int, int> crossing_edges(const std::vector<Vector3>& points) {
  const int count = static_cast<int>(points.size());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      const Vector3 &a = points[i], &b = points[(i + 1) % count], &c = points[j], &d = points[(j + 1) % count];
      const bool after = j == i + 1, before = (j + 1) % count == i;
      const bool fault = after ? folds_back(a, b, d) : before ? folds_back(c, a, b) : segments_meet(a, b, c, d);
      if (fault) return {i, j};
    }
  }
  return {-1, -1};
}

}  // namespace mpm
