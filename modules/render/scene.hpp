// A perspective view of balls on a ground plane, softly lit.
#pragma once

#include <vector>

#include "render/ambient_occlusion.hpp"
#include "render/ball_view.hpp"
#include "render/camera.hpp"
#include "render/gl_canvas.hpp"
#include "render/ground_shadow.hpp"

namespace mpm::render {

/// Balls, ground, soft shadow and the domain's edges, with ambient occlusion. A picture of it is made in three turns.
class Scene {
 public:
  /// `lower` and `upper` bound the domain; `line_width` is that of the edges, pixels; `samples` are those that the
  /// picture has a pixel in each direction.
  Scene(const std::vector<Ball>& balls, const Vec3& lower, const Vec3& upper, const Camera& camera, double line_width,
        int samples);

  /// Draws what the balls stand on and in: ground and edges.
  void draw_room(GlCanvas& canvas) const;
  /// Paints the balls over what is drawn, where neither ground nor edges hide them.
  void paint_balls(const TileSamples& tile) const;
  /// Darkens what sees little of the sky.
  void darken(Image& picture) const;

 private:
  /// Samples of the view that lie in a tile, and the tile's column and row of the view's first.
  struct Part {
    Window window;
    int left, top;
  };
  Part part_in(const TileSamples& tile) const;
  /// Metres ahead at which a ray meets the rectangle of the ground; infinite where it does not.
  float ground_ahead(float to_right, float upwards) const;
  void paint_edge(const Vec3& from, const Vec3& to, const Part& part, const TileSamples& tile) const;
  Window darkened(double radius) const;
  GeometryBuffer geometry_in(const Window& pixels) const;

  Camera camera_;
  Vec3 lower_, upper_;
  double line_width_;
  int samples_;
  std::array<double, 2> occlusion_radii_;
  GroundShadow ground_;
  SeenBalls balls_;
  Rays rays_;
  BallView view_;
};

}  // namespace mpm::render
