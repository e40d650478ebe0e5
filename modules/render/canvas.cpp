#include "render/canvas.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "render/font.hpp"

namespace mpm::render {

std::vector<Point> marker_outline(Marker shape, Point c, double r) {
  switch (shape) {
    case Marker::circle: {
      std::vector<Point> points;
      constexpr int sides = 28;
      for (int i = 0; i < sides; ++i) {
        const double angle = 2 * std::numbers::pi * i / sides;
        points.push_back({c.x + r * std::cos(angle), c.y + r * std::sin(angle)});
      }
      return points;
    }
    case Marker::square: {
      const double s = 0.89 * r;  // half the side of the square with the circle's area
      return {{c.x - s, c.y - s}, {c.x + s, c.y - s}, {c.x + s, c.y + s}, {c.x - s, c.y + s}};
    }
    case Marker::triangle:
      return {{c.x, c.y - 1.3 * r}, {c.x + 1.12 * r, c.y + 0.75 * r}, {c.x - 1.12 * r, c.y + 0.75 * r}};
    case Marker::down_triangle:
      return {{c.x, c.y + 1.3 * r}, {c.x - 1.12 * r, c.y - 0.75 * r}, {c.x + 1.12 * r, c.y - 0.75 * r}};
    case Marker::diamond: {
      const double s = 1.3 * r;
      return {{c.x, c.y - s}, {c.x + s, c.y}, {c.x, c.y + s}, {c.x - s, c.y}};
    }
    case Marker::plus:
    case Marker::cross:
      break;
  }
  return {};
}

double Canvas::measure_text(std::string_view utf8, double size, bool bold) const {
  return FontSet::of_this_thread().width(utf8, bold) * size;
}

void Canvas::quadrilaterals(std::span<const Vertex> vertices) {
  for (std::size_t i = 0; i + 3 < vertices.size(); i += 4)
    polygon(std::array{vertices[i].at, vertices[i + 1].at, vertices[i + 2].at, vertices[i + 3].at}, vertices[i].colour);
}

void Canvas::line(Point a, Point b, const Stroke& stroke) {
  polyline(std::array{a, b}, stroke);
}

void Canvas::rectangle(const Box& b, const Colour& fill) {
  polygon(std::array<Point, 4>{{{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}}}, fill);
}

void Canvas::outline(const Box& b, const Stroke& stroke) {
  polyline(std::array<Point, 5>{{{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}, {b.x0, b.y0}}}, stroke);
}

void Canvas::marker(Point c, Marker shape, double r, const Colour& fill, const Stroke& edge) {
  if (shape == Marker::plus || shape == Marker::cross) {
    const double s = shape == Marker::plus ? 1.2 * r : 0.0, d = shape == Marker::cross ? 0.9 * r : 0.0;
    const Stroke arm{edge.colour, std::max(edge.width, 0.45 * r)};
    if (shape == Marker::plus) line({c.x - s, c.y}, {c.x + s, c.y}, arm), line({c.x, c.y - s}, {c.x, c.y + s}, arm);
    if (shape == Marker::cross)
      line({c.x - d, c.y - d}, {c.x + d, c.y + d}, arm), line({c.x - d, c.y + d}, {c.x + d, c.y - d}, arm);
    return;
  }
  auto points = marker_outline(shape, c, r);
  if (fill.a > 0) polygon(points, fill);
  if (edge.width <= 0) return;
  points.push_back(points[0]);
  points.push_back(points[1]);  // the second point again, so that the closing corner is joined too
  polyline(points, edge);
}

Box text_box(const Canvas& canvas, Point at, std::string_view utf8, const TextStyle& style) {
  const double width = canvas.measure_text(utf8, style.size, style.bold);
  const double shift = style.anchor == Anchor::start ? 0 : style.anchor == Anchor::middle ? width / 2 : width;
  const double drop = style.baseline == Baseline::alphabetic ? 0
                      : style.baseline == Baseline::middle   ? kCapHeight * style.size / 2
                                                             : kCapHeight * style.size;
  const double base = at.y + drop;
  return {at.x - shift, base - (kCapHeight + 0.06) * style.size, at.x - shift + width, base + kDescent * style.size};
}

}  // namespace mpm::render
