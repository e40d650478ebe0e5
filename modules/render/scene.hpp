// A perspective view of balls on a ground plane, softly lit.
#pragma once

#include <array>
#include <vector>

#include "render/canvas.hpp"
#include "render/image.hpp"

namespace mpm::render {

using Vec3 = std::array<double, 3>;

struct Ball {
  Vec3 centre;  ///< m, the third axis upwards
  double radius;
  Colour colour;
};

/// Looks at the domain's box from a fixed direction, so that every frame of a film has the same view.
class Camera {
 public:
  /// `lower` and `upper` bound the domain, third axis upwards; `inner` is the rectangle of pixels that the box fills
  /// but does not leave; `view` is the whole rectangle of the picture that is rendered, in whole pixels.
  Camera(const Vec3& lower, const Vec3& upper, const Box& inner, const Box& view);

  /// Where a point of space falls on the picture.
  Point project(const Vec3& point) const;
  /// Coordinates seen from the eye: x right, y up, -z forward.
  Vec3 to_eye(const Vec3& point) const;
  /// The map to_eye as a column-major matrix for OpenGL.
  std::array<double, 16> matrix() const;

  const Box& view() const { return view_; }
  double scale() const { return scale_; }            // pixels per unit of tangent
  Point axis() const { return {axis_x_, axis_y_}; }  // the pixel straight ahead
  double near_plane() const { return near_; }
  double far_plane() const { return far_; }

 private:
  Vec3 eye_, right_, up_, back_;
  Box view_;
  double scale_ = 1, axis_x_ = 0, axis_y_ = 0, near_ = 0, far_ = 1;
};

/// Renders balls, ground, soft shadow and the domain's edges with ambient occlusion; as large as the camera's view.
/// `line_width` is that of the edges, pixels. Throws std::runtime_error when OpenGL cannot be used.
Image render_scene(const std::vector<Ball>& balls, const Vec3& lower, const Vec3& upper, const Camera& camera,
                   double line_width);

}  // namespace mpm::render
