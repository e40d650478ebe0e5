#include "render/ground_shadow.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::render {
namespace {

constexpr int kSize = 384;
constexpr int kLayers = 6;
constexpr double kDarkest = 0.38;
constexpr double kReach[kLayers] = {0.03, 0.08, 0.16, 0.28, 0.5, 1e9};  ///< heights as fractions of the ground's length
constexpr int kBlur[kLayers] = {2, 3, 5, 7, 10, 14};  ///< cells; a shadow softens with the height of what casts it

using Grid = std::vector<float>;

/// Takes the running mean along one direction; three of them come close to a Gaussian.
void blur_rows(Grid& grid, int radius, std::size_t along, std::size_t across) {
  std::vector<float> line(kSize);
  for (std::size_t row = 0; row < kSize; ++row) {
    for (std::size_t i = 0; i < kSize; ++i) line[i] = grid[row * across + i * along];
    const auto at = [&](int i) { return i < 0 || i >= kSize ? 0.0f : line[static_cast<std::size_t>(i)]; };
    float sum = 0;
    for (int i = -radius; i <= radius; ++i) sum += at(i);
    for (int i = 0; i < kSize; ++i) {
      grid[row * across + static_cast<std::size_t>(i) * along] = sum / static_cast<float>(2 * radius + 1);
      sum += at(i + radius + 1) - at(i - radius);
    }
  }
}

void splat(Grid& grid, double cx, double cy, double rx, double ry) {
  const int x0 = std::max(0, static_cast<int>(cx - rx)), x1 = std::min(kSize - 1, static_cast<int>(cx + rx));
  const int y0 = std::max(0, static_cast<int>(cy - ry)), y1 = std::min(kSize - 1, static_cast<int>(cy + ry));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const double dx = (x + 0.5 - cx) / rx, dy = (y + 0.5 - cy) / ry;
      if (dx * dx + dy * dy <= 1) grid[static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x)] = 1;
    }
  }
}

}  // namespace

GroundShadow cast_shadow(const std::vector<Ball>& balls, const Vec3& to_light, double ground, double x0, double y0,
                         double x1, double y1) {
  GroundShadow shadow{x0, y0, x1, y1, kSize, Grid(static_cast<std::size_t>(kSize) * kSize, 1.0f)};
  const double length = std::max(x1 - x0, y1 - y0), sx = kSize / (x1 - x0), sy = kSize / (y1 - y0);
  std::vector<Grid> layers(kLayers, Grid(shadow.light.size(), 0.0f));
  for (const Ball& ball : balls) {
    const double height = ball.centre[2] - ground;
    if (height < -ball.radius) continue;
    int layer = 0;
    while (height > kReach[layer] * length) ++layer;
    const double x = ball.centre[0] - to_light[0] / to_light[2] * height;
    const double y = ball.centre[1] - to_light[1] / to_light[2] * height;
    const double least = 1.0;  // radius in cells: a ball smaller than a cell still casts something
    const double cx = (x - x0) * sx, cy = (y - y0) * sy;
    if (!(cx > -kSize && cx < 2 * kSize && cy > -kSize && cy < 2 * kSize)) continue;
    splat(layers[static_cast<std::size_t>(layer)], cx, cy, std::max(ball.radius * sx, least),
          std::max(ball.radius * sy, least));
  }
  for (int k = 0; k < kLayers; ++k) {
    Grid& grid = layers[static_cast<std::size_t>(k)];
    for (int pass = 0; pass < 3; ++pass) blur_rows(grid, kBlur[k], 1, kSize), blur_rows(grid, kBlur[k], kSize, 1);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      shadow.light[i] = std::min(shadow.light[i], static_cast<float>(1 - kDarkest * grid[i]));
    }
  }
  return shadow;
}

}  // namespace mpm::render
