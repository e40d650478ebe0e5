// Regions made of other regions: combined, turned and moved.
#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "experiment/geometry.hpp"
#include "support/numbers.hpp"

namespace mpm {
namespace {

using support::infinity;

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
  double distance(const Vector3& point) const override {
    double nearest = parts_[0]->distance(point);
    for (std::size_t k = 1; k < parts_.size(); ++k) {
      const double d = parts_[k]->distance(point);
      nearest =
          how_ == Combination::join ? std::min(nearest, d) : std::max(nearest, how_ == Combination::subtract ? -d : d);
    }
    return nearest;
  }
  std::pair<double, double> extent(const Vector3& direction) const override {
    auto ends = parts_[0]->extent(direction);
    if (how_ == Combination::subtract) return ends;
    const bool join = how_ == Combination::join;
    for (const GeometryPointer& part : parts_) {
      const auto [low, high] = part->extent(direction);
      ends.first = join ? std::min(ends.first, low) : std::max(ends.first, low);
      ends.second = join ? std::max(ends.second, high) : std::min(ends.second, high);
    }
    return ends;
  }
  /// That of the first part.
  Frame frame() const override { return parts_[0]->frame(); }
  double smallest_radius() const override {
    double radius = infinity;
    for (const GeometryPointer& part : parts_) radius = std::min(radius, part->smallest_radius());
    return radius;
  }
  Surface surface(double spacing, const std::pair<Vector3, Vector3>& within) const override {
    std::vector<Surface> of_parts;
    std::vector<std::function<bool(const Vector3&)>> parts;
    for (const GeometryPointer& part : parts_) {
      of_parts.push_back(part->surface(spacing, within));
      parts.emplace_back([part](const Vector3& point) { return part->contains(point); });
    }
    return surface_of_whole(
        of_parts, [this](const Vector3& point) { return contains(point); }, parts, spacing);
  }

 private:
  Combination how_;
  std::vector<GeometryPointer> parts_;
};

/// x lies in it where R^T (x - about - by) + about lies in the part.
class Placed final : public Geometry {
 public:
  Placed(GeometryPointer part, const std::array<Vector3, 3>& rotation, const Vector3& about, const Vector3& by)
      : part_(std::move(part)), rotation_(rotation), about_(about), by_(by) {}
  bool contains(const Vector3& point) const override { return part_->contains(back(point)); }
  double distance(const Vector3& point) const override { return part_->distance(back(point)); }
  std::pair<double, double> extent(const Vector3& direction) const override {
    const Vector3 turned = turned_back(direction);
    const auto ends = part_->extent(turned);
    double offset = 0;
    for (int i = 0; i < 3; ++i) offset += direction[i] * (about_[i] + by_[i]) - turned[i] * about_[i];
    return {ends.first + offset, ends.second + offset};
  }
  std::pair<Vector3, Vector3> bounds() const override {
    std::pair<Vector3, Vector3> box{};
    for (int i = 0; i < 3; ++i) {
      Vector3 axis{};
      axis[i] = 1;
      std::tie(box.first[i], box.second[i]) = extent(axis);
    }
    return box;
  }
  Frame frame() const override {
    Frame frame = part_->frame();
    Vector3 arm{};
    for (int i = 0; i < 3; ++i) arm[i] = frame.origin[i] - about_[i];
    arm = turned(arm);
    for (int i = 0; i < 3; ++i) frame.origin[i] = about_[i] + by_[i] + arm[i];
    for (Vector3& axis : frame.axes) axis = turned(axis);
    return frame;
  }
  double smallest_radius() const override { return part_->smallest_radius(); }
  Surface surface(double spacing, const std::pair<Vector3, Vector3>& within) const override {
    std::pair<Vector3, Vector3> box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (int corner = 0; corner < 8; ++corner) {
      Vector3 point{};
      for (int i = 0; i < 3; ++i) point[i] = corner >> i & 1 ? within.second[i] : within.first[i];
      point = back(point);
      for (int i = 0; i < 3; ++i)
        box.first[i] = std::min(box.first[i], point[i]), box.second[i] = std::max(box.second[i], point[i]);
    }
    Surface pieces = part_->surface(spacing, box);
    for (SurfacePiece& piece : pieces) {
      for (int i = 0; i < 3; ++i) piece.point[i] -= about_[i];
      piece.point = turned(piece.point), piece.normal = turned(piece.normal);
      for (int i = 0; i < 3; ++i) piece.point[i] += about_[i] + by_[i];
    }
    return pieces;
  }

 private:
  Vector3 turned(const Vector3& v) const {
    Vector3 result{};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) result[i] += rotation_[i][k] * v[k];
    return result;
  }
  Vector3 turned_back(const Vector3& v) const {
    Vector3 result{};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) result[i] += rotation_[k][i] * v[k];
    return result;
  }
  Vector3 back(const Vector3& point) const {
    Vector3 arm{};
    for (int i = 0; i < 3; ++i) arm[i] = point[i] - about_[i] - by_[i];
    arm = turned_back(arm);
    for (int i = 0; i < 3; ++i) arm[i] += about_[i];
    return arm;
  }

  GeometryPointer part_;
  std::array<Vector3, 3> rotation_;
  Vector3 about_, by_;
};

}  // namespace

std::array<Vector3, 3> rotation_about(const Vector3& axis, double angle) {
  const double length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  const Vector3 n{axis[0] / length, axis[1] / length, axis[2] / length};
  const double c = std::cos(angle), s = std::sin(angle);
  std::array<Vector3, 3> rotation{};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) rotation[i][k] = (i == k ? c : 0) + (1 - c) * n[i] * n[k];
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    rotation[k][i] += s * n[l], rotation[i][k] -= s * n[l];
  }
  return rotation;
}

GeometryPointer make_placed(GeometryPointer part, const std::array<Vector3, 3>& rotation, const Vector3& about,
                            const Vector3& by) {
  return std::make_shared<Placed>(std::move(part), rotation, about, by);
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

}  // namespace mpm
