// Which ball each sample of a picture sees, and the light that comes from there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/camera.hpp"

namespace mpm::render {

/// A particle of a 3-D picture.
struct Ball {
  Vec3 centre;  ///< m, the third axis upwards
  double radius;
  Colour colour;
};

/// Rays from the eye through the samples of a picture: that of column i and row j goes along (x[i], y[j], -1).
struct Rays {
  std::vector<float> x, y;
  float step;  ///< from one to the next
};
Rays rays_through(const Camera& camera, int samples);

/// Columns x0 ... x1 - 1 of rows y0 ... y1 - 1.
struct Window {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool is_empty() const { return x0 >= x1 || y0 >= y1; }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

/// Balls between the near and the far plane as the eye sees them, by number; lengths in m.
struct SeenBalls {
  std::vector<float> x, y, ahead, radius;  ///< x to the right, y up, ahead away from the eye
  std::vector<float> red, green, blue;
  std::vector<Window> window;  ///< of samples that may see the ball
  std::size_t count() const { return ahead.size(); }
};
SeenBalls seen_balls(const std::vector<Ball>& balls, const Camera& camera, int samples);

/// What the samples of a window see, rows from the top.
struct BallView {
  Window window;
  std::vector<float> ahead;  ///< to the nearest point of a ball, m; infinite where there is none
  std::vector<int> ball;     ///< its number, 0 where there is none
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y - window.y0) * static_cast<std::size_t>(window.width()) +
           static_cast<std::size_t>(x - window.x0);
  }
};
/// `window` holds the windows of all balls.
BallView view_of(const SeenBalls& balls, const Rays& rays, const Window& window);

/// The light of the samples in row `y` of the view, as RGBA of 8 bits each; what it gives where no ball is means
/// nothing. `to_light` is seen from the eye.
void light_row(const SeenBalls& balls, const BallView& view, const Rays& rays, int y, const Vec3& to_light,
               std::vector<std::uint32_t>& rgba);

/// The unit vector away from the ball's centre at the point that a sample sees.
std::array<float, 3> normal_at(const SeenBalls& balls, const BallView& view, const Rays& rays, int x, int y);

}  // namespace mpm::render
