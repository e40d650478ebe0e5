#include "experiment/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double squared_distance(int dimension, const Vector3& a, const Vector3& b) {
  double sum = 0;
  for (int i = 0; i < dimension; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
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
  double smallest_radius() const override { return radius_; }

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
  double smallest_radius() const override { return inner_ > 0 ? inner_ : outer_; }

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

 private:
  static bool on_edge(const Vector3& p, const Vector3& a, const Vector3& b) {
    const double cross = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    const double along = (p[0] - a[0]) * (p[0] - b[0]) + (p[1] - a[1]) * (p[1] - b[1]);
    return cross == 0 && along <= 0;
  }

  std::vector<Vector3> points_;
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

 private:
  int dimension_;
  Vector3 point_, normal_;
};

enum class Combination { join, intersect, subtract };

class Combined final : public Geometry {
 public:
  Combined(Combination how, std::vector<GeometryPointer> parts) : how_(how), parts_(std::move(parts)) {}
  bool contains(const Vector3& point) const override {
    const auto holds = [&](const GeometryPointer& part) { return part->contains(point); };
    switch (how_) {
      case Combination::join:
        return std::any_of(parts_.begin(), parts_.end(), holds);
      case Combination::intersect:
        return std::all_of(parts_.begin(), parts_.end(), holds);
      case Combination::subtract:
        return holds(parts_[0]) && std::none_of(parts_.begin() + 1, parts_.end(), holds);
    }
    return false;
  }
  std::pair<Vector3, Vector3> bounds() const override {
    auto box = parts_[0]->bounds();
    if (how_ == Combination::subtract) return box;
    const bool join = how_ == Combination::join;
    for (const GeometryPointer& part : parts_) {
      const auto [lower, upper] = part->bounds();
      for (int i = 0; i < 3; ++i) {
        box.first[i] = join ? std::min(box.first[i], lower[i]) : std::max(box.first[i], lower[i]);
        box.second[i] = join ? std::max(box.second[i], upper[i]) : std::min(box.second[i], upper[i]);
      }
    }
    return box;
  }
  double smallest_radius() const override {
    double radius = infinity;
    for (const GeometryPointer& part : parts_) radius = std::min(radius, part->smallest_radius());
    return radius;
  }

 private:
  Combination how_;
  std::vector<GeometryPointer> parts_;
};

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
GeometryPointer make_half_space(int dimension, const Vector3& point, const Vector3& normal) {
  return std::make_shared<HalfSpace>(dimension, point, normal);
}
GeometryPointer make_union(std::vector<GeometryPointer> parts) {
  return std::make_shared<Combined>(Combination::join, std::move(parts));
}
GeometryPointer make_intersection(std::vector<GeometryPointer> parts) {
  return std::make_shared<Combined>(Combination::intersect, std::move(parts));
}
GeometryPointer make_difference(std::vector<GeometryPointer> parts) {
  return std::make_shared<Combined>(Combination::subtract, std::move(parts));
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
