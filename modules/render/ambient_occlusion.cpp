#include "render/ambient_occlusion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mpm::render {
namespace {

constexpr int kRays = 10;       ///< samples a radius
constexpr int kPattern = 4;     ///< the sample disc turns in a 4 x 4 pattern, which a 4 x 4 mean then smooths away
constexpr float kBias = 0.08f;  ///< sine of the angle below which a neighbour counts as the same surface

float occlusion(const GeometryBuffer& g, int x, int y, double radius, double scale) {
  const std::size_t here = static_cast<std::size_t>(y) * g.width + x;
  const auto& p = g.position[here];
  const auto& n = g.normal[here];
  const double reach = std::clamp(radius * scale / -p[2], 2.0, 0.25 * g.width);
  const double turn = 2 * std::numbers::pi * ((x % kPattern) * kPattern + y % kPattern) / (kPattern * kPattern);
  float sum = 0;
  for (int k = 0; k < kRays; ++k) {
    const double r = reach * std::sqrt((k + 0.5) / kRays), angle = turn + 2.39996323 * k;  // turned by the golden angle
    const int sx = x + static_cast<int>(std::lround(r * std::cos(angle)));
    const int sy = y + static_cast<int>(std::lround(r * std::sin(angle)));
    if (sx < 0 || sy < 0 || sx >= g.width || sy >= g.height) continue;
    const auto& q = g.position[static_cast<std::size_t>(sy) * g.width + sx];
    if (q[2] == 0) continue;
    const float v[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    const float length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + 1e-20f;
    const float sine = (v[0] * n[0] + v[1] * n[1] + v[2] * n[2]) / length;
    const float fade = std::max(0.0f, 1 - length / static_cast<float>(2 * radius));
    sum += std::max(0.0f, sine - kBias) * fade;
  }
  return sum / kRays;
}

/// The mean over the pattern, within the same surface only, so that outlines stay sharp.
std::vector<float> smoothed(const GeometryBuffer& g, const std::vector<float>& values, double tolerance) {
  std::vector<float> result(values.size(), 1);
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      const std::size_t here = static_cast<std::size_t>(y) * g.width + x;
      const float z = g.position[here][2];
      if (z == 0) continue;
      float sum = 0, count = 0;
      for (int j = std::max(0, y - 2); j < std::min(g.height, y + 2); ++j) {
        for (int i = std::max(0, x - 2); i < std::min(g.width, x + 2); ++i) {
          const std::size_t other = static_cast<std::size_t>(j) * g.width + i;
          if (g.position[other][2] == 0 || std::fabs(g.position[other][2] - z) > tolerance) continue;
          sum += values[other];
          ++count;
        }
      }
      result[here] = count > 0 ? sum / count : values[here];
    }
  }
  return result;
}

}  // namespace

std::vector<float> open_sky(const GeometryBuffer& g, const std::array<double, 2>& radii, double scale) {
  std::vector<float> open(g.position.size(), 1);
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      const std::size_t here = static_cast<std::size_t>(y) * g.width + x;
      if (g.position[here][2] == 0) continue;
      const float sum = occlusion(g, x, y, radii[0], scale) + occlusion(g, x, y, radii[1], scale);
      open[here] = std::clamp(1 - 1.1f * sum, 0.0f, 1.0f);
    }
  }
  return smoothed(g, open, radii[1]);
}

}  // namespace mpm::render
