#include "render/polyline.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mpm::render {

std::vector<std::vector<Point>> dashes(std::span<const Point> points, std::span<const double> pattern) {
  const double period = std::accumulate(pattern.begin(), pattern.end(), 0.0);
  if (points.size() < 2 || !(period > 0)) return {std::vector<Point>(points.begin(), points.end())};
  std::vector<std::vector<Point>> pieces;
  std::size_t phase = 0;
  double left = pattern[0];
  std::vector<Point> piece{points[0]};
  const auto flush = [&] {
    if (phase % 2 == 0 && piece.size() > 1) pieces.push_back(piece);
  };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Point a = points[i], b = points[i + 1];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    double done = 0;
    while (length - done > left) {
      done += left;
      const Point cut{a.x + (b.x - a.x) * done / length, a.y + (b.y - a.y) * done / length};
      piece.push_back(cut);
      flush();
      piece = {cut};
      phase = (phase + 1) % (pattern.size() % 2 == 0 ? pattern.size() : 2 * pattern.size());
      left = pattern[phase % pattern.size()];
    }
    left -= length - done;
    piece.push_back(b);
  }
  flush();
  return pieces;
}

std::vector<Point> thinned(std::span<const Point> points) {
  if (points.size() < 2000) return {points.begin(), points.end()};
  std::vector<Point> kept;
  for (std::size_t begin = 0; begin < points.size();) {
    const double column = std::floor(points[begin].x * 2);
    std::size_t end = begin, lowest = begin, highest = begin;
    for (; end < points.size() && std::floor(points[end].x * 2) == column; ++end) {
      if (points[end].y < points[lowest].y) lowest = end;
      if (points[end].y > points[highest].y) highest = end;
    }
    std::size_t chosen[] = {begin, std::min(lowest, highest), std::max(lowest, highest), end - 1};
    for (std::size_t k = 0; k < 4; ++k) {
      if (k == 0 || chosen[k] != chosen[k - 1]) kept.push_back(points[chosen[k]]);
    }
    begin = end;
  }
  return kept;
}

bool crosses(Point a, Point b, const Box& box) {
  // Liang-Barsky: the part of the segment inside all four half planes.
  double enter = 0, leave = 1;
  const auto cut = [&](double direction, double distance) {
    if (direction == 0) return distance >= 0;
    const double t = distance / direction;
    if (direction < 0) enter = std::max(enter, t);
    if (direction > 0) leave = std::min(leave, t);
    return enter <= leave;
  };
  const double dx = b.x - a.x, dy = b.y - a.y;
  return cut(-dx, a.x - box.x0) && cut(dx, box.x1 - a.x) && cut(-dy, a.y - box.y0) && cut(dy, box.y1 - a.y);
}

}  // namespace mpm::render
