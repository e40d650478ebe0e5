// An abstract 2-D drawing surface in pixels: layout code draws once, a raster and a vector canvas carry it out.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "render/colours.hpp"

namespace mpm::render {

/// A place in pixels; x to the right, y downwards, origin at the top left.
struct Point {
  double x = 0, y = 0;
};

/// An axis-aligned rectangle in pixels, x0 <= x1 and y0 <= y1.
struct Box {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
  Point centre() const { return {(x0 + x1) / 2, (y0 + y1) / 2}; }
  bool overlaps(const Box& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
  bool contains(const Point& p) const { return p.x >= x0 && p.x <= x1 && p.y >= y0 && p.y <= y1; }
};

/// A line's look; `dash` alternates drawn and blank lengths in pixels, empty for a solid line.
struct Stroke {
  Colour colour = kInk;
  double width = 1;
  std::vector<double> dash = {};
};

struct Vertex {
  Point at;
  Colour colour;
};

enum class Marker { circle, square, triangle, diamond, down_triangle, plus, cross };
enum class Anchor { start, middle, end };
enum class Baseline { alphabetic, middle, top };

/// How text is set: `size` is the em in pixels; `rotation` turns counter-clockwise about the anchor, degrees.
struct TextStyle {
  double size = 20;
  Colour colour = kInk;
  Anchor anchor = Anchor::start;
  Baseline baseline = Baseline::alphabetic;
  double rotation = 0;
  bool bold = false;
};

/// The outline of a marker of half-width `radius`; empty for the marks that are strokes only (plus, cross).
std::vector<Point> marker_outline(Marker shape, Point centre, double radius);

class Canvas {
 public:
  virtual ~Canvas() = default;

  virtual void polyline(std::span<const Point> points, const Stroke& stroke) = 0;
  /// Fills a convex polygon.
  virtual void polygon(std::span<const Point> points, const Colour& fill) = 0;
  /// Fills convex quadrilaterals, four vertices each, every one in the opaque colour of its first, in their order.
  virtual void quadrilaterals(std::span<const Vertex> vertices);
  /// Fills the band between two lines of equally many points.
  virtual void band(std::span<const Point> upper, std::span<const Point> lower, const Colour& fill) = 0;
  /// Fills triangles, three vertices each, colours interpolated where the canvas can.
  virtual void triangles(std::span<const Vertex> vertices) = 0;
  /// Writes text; `at` is the anchor, and the text is UTF-8, superscript and subscript digits included.
  virtual void text(Point at, std::string_view utf8, const TextStyle& style) = 0;
  /// Clips: nothing is drawn outside `box` until unclip().
  virtual void clip(const Box& box) = 0;
  virtual void unclip() = 0;

  /// Width in pixels of one line of text.
  double measure_text(std::string_view utf8, double size, bool bold = false) const;

  void line(Point a, Point b, const Stroke& stroke);
  void rectangle(const Box& box, const Colour& fill);
  void outline(const Box& box, const Stroke& stroke);
  /// Draws a closed mark; `fill` with opacity 0 leaves it hollow.
  void marker(Point centre, Marker shape, double radius, const Colour& fill, const Stroke& edge);
};

/// The box that a line of text covers, from cap height to descender, rotation left out.
Box text_box(const Canvas& canvas, Point at, std::string_view utf8, const TextStyle& style);

}  // namespace mpm::render
