#include "render/ambient_occlusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mpm::render {
namespace {

constexpr int kRays = 10;       ///< samples a radius
constexpr int kPattern = 4;     ///< the sample disc turns in a 4 x 4 pattern, which a 4 x 4 mean then smooths away
constexpr float kBias = 0.08f;  ///< sine of the angle below which a neighbour counts as the same surface

/// Where the rays of each turn of the pattern end, of a disc of radius 1.
struct Rays {
  std::array<std::array<float, 2>, kPattern * kPattern * kRays> end;
  Rays() {
    for (int turn = 0; turn < kPattern * kPattern; ++turn)
      for (int k = 0; k < kRays; ++k) {
        const double r = std::sqrt((k + 0.5) / kRays);
        const double angle = 2 * std::numbers::pi * turn / (kPattern * kPattern) + 2.39996323 * k;  // the golden angle
        end[static_cast<std::size_t>(turn * kRays + k)] = {static_cast<float>(r * std::cos(angle)),
                                                           static_cast<float>(r * std::sin(angle))};
      }
  }
};

float occlusion(const GeometryBuffer& g, int x, int y, float radius, float scale) {
  static const Rays rays;
  const std::size_t here = static_cast<std::size_t>(y) * g.width + x;
  const auto& p = g.position[here];
  const auto& n = g.normal[here];
  const float reach = std::clamp(radius * scale / -p[2], 2.0f, 0.25f * static_cast<float>(g.width));
  const auto* end = &rays.end[static_cast<std::size_t>(((x % kPattern) * kPattern + y % kPattern) * kRays)];
  float sum = 0;
  for (int k = 0; k < kRays; ++k) {
    const int sx = static_cast<int>(static_cast<float>(x) + reach * end[k][0] + 0.5f);
    const int sy = static_cast<int>(static_cast<float>(y) + reach * end[k][1] + 0.5f);
    if (sx < 0 || sy < 0 || sx >= g.width || sy >= g.height) continue;
    const auto& q = g.position[static_cast<std::size_t>(sy) * g.width + sx];
    if (q[2] == 0) continue;
    const float v[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    const float length2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (length2 >= 4 * radius * radius) continue;
    const float length = std::sqrt(length2) + 1e-20f;
    const float sine = (v[0] * n[0] + v[1] * n[1] + v[2] * n[2]) / length;
    sum += std::max(0.0f, sine - kBias) * (1 - length / (2 * radius));
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
      const float sum = occlusion(g, x, y, static_cast<float>(radii[0]), static_cast<float>(scale)) +
                        occlusion(g, x, y, static_cast<float>(radii[1]), static_cast<float>(scale));
      open[here] = std::clamp(1 - 1.1f * sum, 0.0f, 1.0f);
    }
  }
  return smoothed(g, open, radii[1]);
}

}  // namespace mpm::render
