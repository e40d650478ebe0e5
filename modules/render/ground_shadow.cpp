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

using Coverage = std::vector<float>;

/// Takes the running mean over the rows of each column; three of them come close to a Gaussian. Columns go side by
/// side, in lanes.
void blur_columns(Coverage& grid, int radius) {
  const Coverage before = grid;
  std::vector<float> sum(kSize, 0.0f);
  const auto add = [&](int row, float sign) {
    if (row < 0 || row >= kSize) return;
    const float* values = &before[static_cast<std::size_t>(row) * kSize];
    for (std::size_t i = 0; i < kSize; ++i) sum[i] += sign * values[i];
  };
  for (int row = 0; row < radius; ++row) add(row, 1);
  for (int row = 0; row < kSize; ++row) {
    add(row + radius, 1);
    add(row - radius - 1, -1);
    float* mean = &grid[static_cast<std::size_t>(row) * kSize];
    for (std::size_t i = 0; i < kSize; ++i) mean[i] = sum[i] / static_cast<float>(2 * radius + 1);
  }
}

void transpose(Coverage& grid) {
  for (std::size_t y = 0; y < kSize; ++y)
    for (std::size_t x = 0; x < y; ++x) std::swap(grid[y * kSize + x], grid[x * kSize + y]);
}

/// Softens a layer of shadow in both directions.
void blur(Coverage& grid, int radius) {
  for (int direction = 0; direction < 2; ++direction) {
    for (int pass = 0; pass < 3; ++pass) blur_columns(grid, radius);
    transpose(grid);
  }
}

/// Fills the cells whose centres lie in an ellipse, row by row.
void splat(Coverage& grid, double cx, double cy, double rx, double ry) {
  const int y0 = std::max(0, static_cast<int>(cy - ry)), y1 = std::min(kSize - 1, static_cast<int>(cy + ry));
  for (int y = y0; y <= y1; ++y) {
    const double dy = (y + 0.5 - cy) / ry;
    if (dy * dy > 1) continue;
    const double half = rx * std::sqrt(1 - dy * dy);
    const int x0 = std::max(0, static_cast<int>(std::ceil(cx - half - 0.5)));
    const int x1 = std::min(kSize - 1, static_cast<int>(std::floor(cx + half - 0.5)));
    float* const row = &grid[static_cast<std::size_t>(y) * kSize];
    for (int x = x0; x <= x1; ++x) row[x] = 1;
  }
}

}  // namespace

GroundShadow cast_shadow(const std::vector<Ball>& balls, const Vec3& to_light, double ground, double x0, double y0,
                         double x1, double y1) {
  GroundShadow shadow{x0, y0, x1, y1, kSize, Coverage(static_cast<std::size_t>(kSize) * kSize, 1.0f)};
  const double length = std::max(x1 - x0, y1 - y0), sx = kSize / (x1 - x0), sy = kSize / (y1 - y0);
  std::vector<Coverage> layers(kLayers);  // those that nothing falls into stay empty
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
    Coverage& grid = layers[static_cast<std::size_t>(layer)];
    grid.resize(shadow.light.size());
    splat(grid, cx, cy, std::max(ball.radius * sx, least), std::max(ball.radius * sy, least));
  }
  for (int k = 0; k < kLayers; ++k) {
    Coverage& grid = layers[static_cast<std::size_t>(k)];
    if (grid.empty()) continue;
    blur(grid, kBlur[k]);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      shadow.light[i] = std::min(shadow.light[i], static_cast<float>(1 - kDarkest * grid[i]));
    }
  }
  return shadow;
}

}  // namespace mpm::render
