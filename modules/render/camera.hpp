// Where the eye of a 3-D picture is, and where it sees things.
#pragma once

#include <array>
#include <cmath>

#include "render/canvas.hpp"

namespace mpm::render {

using Vec3 = std::array<double, 3>;

inline double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec3 minus(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vec3 unit(const Vec3& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

/// The corners of a box: bit d of a corner's number says whether it is the upper one along axis d.
std::array<Vec3, 8> corners_of(const Vec3& lower, const Vec3& upper);

/// Looks at the domain's box from a fixed direction, so that every frame of a film has the same view.
class Camera {
 public:
  /// `lower` and `upper` bound the domain, third axis upwards; `inner` is the rectangle of pixels that the box fills
  /// but does not leave; `view` is the whole rectangle of the picture that the scene has, in whole pixels.
  Camera(const Vec3& lower, const Vec3& upper, const Box& inner, const Box& view);

  /// Where a point of space falls on the picture.
  Point project(const Vec3& point) const;
  /// Coordinates seen from the eye: x right, y up, -z forward.
  Vec3 to_eye(const Vec3& point) const;
  /// Metres in front of the eye.
  double ahead_of(const Vec3& point) const { return -to_eye(point)[2]; }
  /// Where the ray with these slopes to the right and upwards goes while it comes one metre ahead.
  Vec3 direction(double to_right, double upwards) const;

  const Vec3& eye() const { return eye_; }
  const Box& view() const { return view_; }
  double scale() const { return scale_; }            // pixels per unit of tangent
  Point axis() const { return {axis_x_, axis_y_}; }  // the pixel straight ahead
  double nearest() const { return near_; }           // metres ahead between which things are seen
  double farthest() const { return far_; }

 private:
  Vec3 eye_, right_, up_, back_;
  Box view_;
  double scale_ = 1, axis_x_ = 0, axis_y_ = 0, near_ = 0, far_ = 1;
};

}  // namespace mpm::render
