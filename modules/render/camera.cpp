#include "render/camera.hpp"

#include <algorithm>

#include "render/chart.hpp"

namespace mpm::render {
namespace {

constexpr Vec3 kViewDirection{0.42, -0.83, 0.36};  ///< from the domain towards the eye

}  // namespace

std::array<Vec3, 8> corners_of(const Vec3& lo, const Vec3& hi) {
  std::array<Vec3, 8> corners;
  for (int k = 0; k < 8; ++k) {
    corners[static_cast<std::size_t>(k)] = {k & 1 ? hi[0] : lo[0], k & 2 ? hi[1] : lo[1], k & 4 ? hi[2] : lo[2]};
  }
  return corners;
}

Camera::Camera(const Vec3& lo, const Vec3& hi, const Box& inner, const Box& view) : view_(view) {
  const Vec3 centre{(lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2, (lo[2] + hi[2]) / 2};
  const Vec3 size = minus(hi, lo);
  const double diagonal = std::sqrt(dot(size, size));
  back_ = unit(kViewDirection);
  right_ = unit(cross({0, 0, 1}, back_));
  up_ = cross(back_, right_);
  const double distance = 2.4 * diagonal;
  for (std::size_t d = 0; d < 3; ++d) eye_[d] = centre[d] + distance * back_[d];
  near_ = distance - diagonal;
  far_ = distance + diagonal;
  Range horizontal, vertical;
  for (const Vec3& corner : corners_of(lo, hi)) {
    const Vec3 p = to_eye(corner);
    horizontal.add(p[0] / -p[2]);
    vertical.add(p[1] / -p[2]);
  }
  const double width = *horizontal.hi - *horizontal.lo, height = *vertical.hi - *vertical.lo;
  scale_ = std::min(inner.width() / width, inner.height() / height);
  axis_x_ = inner.centre().x - scale_ * (*horizontal.hi + *horizontal.lo) / 2;
  axis_y_ = inner.centre().y + scale_ * (*vertical.hi + *vertical.lo) / 2;
}

Vec3 Camera::to_eye(const Vec3& point) const {
  const Vec3 p = minus(point, eye_);
  return {dot(right_, p), dot(up_, p), dot(back_, p)};
}

Point Camera::project(const Vec3& point) const {
  const Vec3 p = to_eye(point);
  return {axis_x_ + scale_ * p[0] / -p[2], axis_y_ - scale_ * p[1] / -p[2]};
}

Vec3 Camera::direction(double dx, double dy) const {
  Vec3 along{};
  for (std::size_t d = 0; d < 3; ++d) along[d] = right_[d] * dx + up_[d] * dy - back_[d];
  return along;
}

}  // namespace mpm::render
