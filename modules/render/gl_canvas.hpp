// The raster canvas: OpenGL triangles and FreeType glyphs, supersampled.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "render/canvas.hpp"
#include "render/image.hpp"
#include "render/osmesa_context.hpp"
#include "render/tile_samples.hpp"

namespace mpm::render {

/// Draws one rectangular tile of a picture; coordinates stay those of the whole picture.
class GlCanvas : public Canvas {
 public:
  /// `tile` is the part of the picture in whole pixels, `samples` the samples a pixel in each direction. Throws
  /// std::runtime_error when no OpenGL context can be made.
  GlCanvas(const Box& tile, int samples);
  ~GlCanvas() override;
  GlCanvas(const GlCanvas&) = delete;
  GlCanvas& operator=(const GlCanvas&) = delete;

  void polyline(std::span<const Point> points, const Stroke& stroke) override;
  void polygon(std::span<const Point> points, const Colour& fill) override;
  void quadrilaterals(std::span<const Vertex> vertices) override;
  void band(std::span<const Point> upper, std::span<const Point> lower, const Colour& fill) override;
  void triangles(std::span<const Vertex> vertices) override;
  void text(Point at, std::string_view utf8, const TextStyle& style) override;
  void clip(const Box& box) override;
  void unclip() override;
  /// Fills a quadrilateral seen in perspective with a colour times the brightness of a square grid of `size` by `size`
  /// values, x fastest, whose corners are those of the quadrilateral in turn.
  struct DistantPoint {
    Point at;
    double ahead;  ///< of the eye, in any unit
  };
  void lit_quadrilateral(const std::array<DistantPoint, 4>& corners, const Colour& colour, int size,
                         std::span<const float> brightness);

  /// Waits for all drawing; what is painted into the samples then lies on top, and nothing is drawn after it.
  TileSamples finished();
  /// The tile, averaged down to one value a pixel.
  Image resolve();

 private:
  struct Glyph {
    unsigned texture = 0;
    int width = 0, height = 0, left = 0, top = 0;
  };
  const Glyph& glyph(int face, unsigned index, double pixels);
  void solid(std::span<const Point> points, const Stroke& stroke);

  Box tile_;
  int samples_;
  OsMesaContext context_;
  std::map<std::tuple<int, unsigned, int>, Glyph> glyphs_;
};

/// Runs `draw` for every tile of a picture of the given size, then `paint` where it is given, and joins the tiles;
/// large pictures cost no more memory.
Image rasterise(int width, int height, int samples, const std::function<void(GlCanvas&)>& draw,
                const std::function<void(const TileSamples&)>& paint = nullptr);

}  // namespace mpm::render
