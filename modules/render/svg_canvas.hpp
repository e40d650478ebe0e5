// The vector canvas: the same primitives as SVG 1.1.
#pragma once

#include <string>

#include "render/canvas.hpp"

namespace mpm::render {

class SvgCanvas : public Canvas {
 public:
  /// `width` and `height` are the pixels of the view box; `title` is the document's title, which screen readers read
  /// out.
  SvgCanvas(int width, int height, std::string_view title);

  void polyline(std::span<const Point> points, const Stroke& stroke) override;
  void polygon(std::span<const Point> points, const Colour& fill) override;
  void band(std::span<const Point> upper, std::span<const Point> lower, const Colour& fill) override;
  /// Fills each triangle with the mean of its colours.
  void triangles(std::span<const Vertex> vertices) override;
  void text(Point at, std::string_view utf8, const TextStyle& style) override;
  void clip(const Box& box) override;
  void unclip() override;

  /// The complete document.
  std::string document() const;

 private:
  void points(std::span<const Point> list);
  void fill(const Colour& colour);
  std::string body_;
  int clips_ = 0;
  bool clipped_ = false;
};

/// Text with &, <, > and quotes written as entities; control characters that XML forbids are left out.
std::string xml_escaped(std::string_view text);

}  // namespace mpm::render
