#include "render/tile_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace mpm::render {
namespace {

std::array<std::uint8_t, 4> bytes_of(const Colour& colour) {
  const auto byte = [](double value) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
  };
  return {byte(colour.r), byte(colour.g), byte(colour.b), 255};
}

/// The first whole number not below `value`, within [lo, hi].
int first_from(double value, int lo, int hi) {
  return static_cast<int>(std::ceil(std::clamp(value, double(lo), double(hi))));
}

/// Where a level line crosses the rim of a convex polygon: from the leftmost to the rightmost point.
std::array<double, 2> crossings(const std::array<Point, 4>& corners, double y) {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  for (std::size_t k = 0; k < 4; ++k) {
    const Point &a = corners[k], &b = corners[(k + 1) % 4];
    if ((a.y <= y) == (b.y <= y)) continue;
    const double x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
    left = std::min(left, x);
    right = std::max(right, x);
  }
  return {left, right};
}

}  // namespace

SpeckPainter::SpeckPainter(const TileSamples& tile, const Box& clip)
    : tile_(tile),
      x0_(first_from((clip.x0 - tile.box.x0) * tile.samples - 0.5, 0, tile.columns)),
      y0_(first_from((clip.y0 - tile.box.y0) * tile.samples - 0.5, 0, tile.rows)),
      x1_(first_from((clip.x1 - tile.box.x0) * tile.samples - 0.5, 0, tile.columns)),
      y1_(first_from((clip.y1 - tile.box.y0) * tile.samples - 0.5, 0, tile.rows)) {}

void SpeckPainter::fill(const std::array<Point, 4>& corners, const Colour& colour) const {
  std::array<Point, 4> in_samples;  // a sample's centre is a whole number
  for (std::size_t k = 0; k < 4; ++k)
    in_samples[k] = {(corners[k].x - tile_.box.x0) * tile_.samples - 0.5,
                     (corners[k].y - tile_.box.y0) * tile_.samples - 0.5};
  const auto [top, bottom] = std::minmax({in_samples[0].y, in_samples[1].y, in_samples[2].y, in_samples[3].y});
  const auto rgba = bytes_of(colour);
  const int end = first_from(bottom, y0_, y1_);
  for (int row = first_from(top, y0_, y1_); row < end; ++row) {
    const auto [left, right] = crossings(in_samples, row);
    const int last = first_from(right, x0_, x1_);
    for (int column = first_from(left, x0_, x1_); column < last; ++column)
      std::memcpy(tile_.at(column, row), rgba.data(), rgba.size());
  }
}

}  // namespace mpm::render
