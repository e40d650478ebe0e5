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

/// Where the rays of the pixels of a row end, of discs of radius 1: one array for each ray, so that lanes are pixels.
class RowOfRays {
 public:
  RowOfRays(int width, int y) {
    for (int k = 0; k < kRays; ++k) {
      const double r = std::sqrt((k + 0.5) / kRays);
      auto& [end_x, end_y] = ends_[static_cast<std::size_t>(k)];
      for (int x = 0; x < width; ++x) {
        const int turn = x % kPattern * kPattern + y;
        const double angle = 2 * std::numbers::pi * turn / (kPattern * kPattern) + 2.39996323 * k;  // the golden angle
        end_x.push_back(x < kPattern ? static_cast<float>(r * std::cos(angle)) : end_x[std::size_t(x - kPattern)]);
        end_y.push_back(x < kPattern ? static_cast<float>(r * std::sin(angle)) : end_y[std::size_t(x - kPattern)]);
      }
    }
  }
  const auto& operator[](int k) const { return ends_[static_cast<std::size_t>(k)]; }

 private:
  std::array<std::array<std::vector<float>, 2>, kRays> ends_;
};

/// Adds to each pixel of row y what a neighbour in the direction of one ray hides of its sky.
void add_occlusion(const GeometryBuffer& g, int y, float radius, const std::array<std::vector<float>, 2>& ends,
                   float* sums) {
  const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(g.width);
  const float *const ahead = g.ahead.data(), *const here = ahead + row;
  const float *const nx = &g.normal_x[row], *const ny = &g.normal_y[row], *const nz = &g.normal_z[row];
  const float *const end_x = ends[0].data(), *const end_y = ends[1].data();
  const int width = g.width, height = g.height;
  const float longest = g.longest_reach, in_pixels = radius / g.pixel;
#pragma omp simd
  for (int x = 0; x < width; ++x) {
    const float z = here[x], reach = std::min(std::max(in_pixels / z, 2.0f), longest);
    const float to_x = static_cast<float>(x) + reach * end_x[x] + 0.5f;
    const float to_y = static_cast<float>(y) + reach * end_y[x] + 0.5f;
    const int sx = static_cast<int>(to_x), sy = static_cast<int>(to_y);
    const bool is_inside = (sx >= 0) & (sy >= 0) & (sx < width) & (sy < height);
    const float other = ahead[is_inside ? sy * width + sx : 0];
    const float vx = g.right_of(sx) * other - g.right_of(x) * z, vy = g.up_of(sy) * other - g.up_of(y) * z;
    const float vz = z - other, length2 = vx * vx + vy * vy + vz * vz, length = std::sqrt(length2) + 1e-20f;
    const float sine = (vx * nx[x] + vy * ny[x] + vz * nz[x]) / length;
    const float hidden = std::max(0.0f, sine - kBias) * (1 - length / (2 * radius));
    const bool counts = is_inside & (other != 0) & (length2 < 4 * radius * radius);
    sums[x] += counts ? hidden : 0.0f;
  }
}

/// The mean over the pattern, within the same surface only, so that outlines stay sharp.
std::vector<float> smoothed(const GeometryBuffer& g, const std::vector<float>& values, float tolerance) {
  std::vector<float> result(values.size(), 1);
  const std::size_t width = static_cast<std::size_t>(g.width);
  std::vector<float> sum(width), count(width);
  for (int y = 0; y < g.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * width;
    std::fill(sum.begin(), sum.end(), 0.0f);
    std::fill(count.begin(), count.end(), 0.0f);
    for (int j = std::max(0, y - 2); j < std::min(g.height, y + 2); ++j)
      for (int i = -2; i < 2; ++i) {
        const int first = std::max(0, -i), last = g.width - std::max(0, i);
        const float *const here = &g.ahead[row], *const other = &g.ahead[static_cast<std::size_t>(j) * width];
        const float* const value = &values[static_cast<std::size_t>(j) * width];
#pragma omp simd
        for (int x = first; x < last; ++x) {
          const bool is_same = (other[x + i] != 0) & (std::fabs(other[x + i] - here[x]) <= tolerance);
          sum[std::size_t(x)] += is_same ? value[x + i] : 0.0f;
          count[std::size_t(x)] += is_same ? 1.0f : 0.0f;
        }
      }
    for (std::size_t x = 0; x < width; ++x)
      if (g.ahead[row + x] != 0 && count[x] > 0) result[row + x] = sum[x] / count[x];
  }
  return result;
}

}  // namespace

std::vector<float> open_sky(const GeometryBuffer& g, const std::array<double, 2>& radii) {
  std::vector<float> open(g.ahead.size(), 1), sums(static_cast<std::size_t>(g.width));
  std::vector<RowOfRays> rays;
  for (int y = 0; y < kPattern; ++y) rays.emplace_back(g.width, y);
  for (int y = 0; y < g.height; ++y) {
    std::fill(sums.begin(), sums.end(), 0.0f);
    for (const double radius : radii)
      for (int k = 0; k < kRays; ++k)
        add_occlusion(g, y, static_cast<float>(radius), rays[std::size_t(y % kPattern)][k], sums.data());
    for (std::size_t x = 0; x < sums.size(); ++x) {
      const std::size_t here = static_cast<std::size_t>(y) * sums.size() + x;
      if (g.ahead[here] != 0) open[here] = std::clamp(1 - 1.1f / kRays * sums[x], 0.0f, 1.0f);
    }
  }
  return smoothed(g, open, static_cast<float>(radii[1]));
}

}  // namespace mpm::render
