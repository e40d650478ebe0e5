// Geometry of lines in pixels.
#pragma once

#include <span>
#include <vector>

#include "render/canvas.hpp"

namespace mpm::render {

/// The drawn pieces of a dashed line; lengths in pixels, alternately drawn and blank.
std::vector<std::vector<Point>> dashes(std::span<const Point> points, std::span<const double> pattern);

/// Fewer points that draw the same line: in each half pixel of x only the first, lowest, highest and last point stay.
std::vector<Point> thinned(std::span<const Point> points);

/// Whether the segment a-b passes through the box.
bool crosses(Point a, Point b, const Box& box);

}  // namespace mpm::render
