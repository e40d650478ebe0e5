#include "render/gl_canvas.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <GL/gl.h>

#include "render/font.hpp"
#include "render/polyline.hpp"

namespace mpm::render {
namespace {

constexpr int kLargestTile = 2048;  ///< pixels of the result; times the samples it stays below every driver's limit

void set_colour(const Colour& c) {
  glColor4d(c.r, c.g, c.b, c.a);
}

void disc(Point c, double radius, int sides) {
  glBegin(GL_TRIANGLE_FAN);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    glVertex2d(c.x + radius * std::cos(angle), c.y + radius * std::sin(angle));
  }
  glEnd();
}

void thick_segment(Point a, Point b, double half) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  if (length == 0) return;
  const double nx = -(b.y - a.y) / length * half, ny = (b.x - a.x) / length * half;
  glBegin(GL_TRIANGLE_STRIP);
  glVertex2d(a.x + nx, a.y + ny);
  glVertex2d(a.x - nx, a.y - ny);
  glVertex2d(b.x + nx, b.y + ny);
  glVertex2d(b.x - nx, b.y - ny);
  glEnd();
}

}  // namespace

GlCanvas::GlCanvas(const Box& tile, int samples)
    : tile_(tile),
      samples_(samples),
      context_(static_cast<int>(tile.width()) * samples, static_cast<int>(tile.height()) * samples) {
  glViewport(0, 0, context_.width(), context_.height());
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glOrtho(tile.x0, tile.x1, tile.y1, tile.y0, -1, 1);
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_DITHER);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glClearColor(1, 1, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

GlCanvas::~GlCanvas() {
  for (const auto& [key, glyph] : glyphs_) glDeleteTextures(1, &glyph.texture);
}

void GlCanvas::polyline(std::span<const Point> points, const Stroke& stroke) {
  if (stroke.dash.empty()) return solid(points, stroke);
  for (const auto& piece : dashes(points, stroke.dash)) solid(piece, stroke);
}

void GlCanvas::solid(std::span<const Point> points, const Stroke& stroke) {
  if (points.size() < 2 || stroke.width <= 0) return;
  set_colour(stroke.colour);
  const double half = stroke.width / 2;
  const int sides = std::clamp(static_cast<int>(half * samples_ * 2), 6, 32);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    thick_segment(points[i], points[i + 1], half);
    // Joins are round; a translucent line would show them, so it goes without.
    if (i > 0 && stroke.colour.a == 1 && stroke.width > 1) disc(points[i], half, sides);
  }
}

void GlCanvas::polygon(std::span<const Point> points, const Colour& fill) {
  set_colour(fill);
  glBegin(GL_TRIANGLE_FAN);
  for (const Point& p : points) glVertex2d(p.x, p.y);
  glEnd();
}

void GlCanvas::quadrilaterals(std::span<const Vertex> vertices) {
  // One call for all of them; opaque colours need no blending, which would read every sample before it writes it.
  struct Corner {
    float at[2], colour[3];
  };
  std::vector<Corner> corners;
  corners.reserve(vertices.size());
  for (std::size_t i = 0; i + 3 < vertices.size(); i += 4) {
    const Colour& c = vertices[i].colour;
    for (std::size_t k = i; k < i + 4; ++k)
      corners.push_back({{static_cast<float>(vertices[k].at.x), static_cast<float>(vertices[k].at.y)},
                         {static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)}});
  }
  if (corners.empty()) return;
  glDisable(GL_BLEND);
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_COLOR_ARRAY);
  glVertexPointer(2, GL_FLOAT, sizeof(Corner), corners.front().at);
  glColorPointer(3, GL_FLOAT, sizeof(Corner), corners.front().colour);
  glDrawArrays(GL_QUADS, 0, static_cast<GLsizei>(corners.size()));
  glDisableClientState(GL_VERTEX_ARRAY);
  glDisableClientState(GL_COLOR_ARRAY);
  glEnable(GL_BLEND);
}

void GlCanvas::band(std::span<const Point> upper, std::span<const Point> lower, const Colour& fill) {
  set_colour(fill);
  glBegin(GL_TRIANGLE_STRIP);
  for (std::size_t i = 0; i < std::min(upper.size(), lower.size()); ++i) {
    glVertex2d(upper[i].x, upper[i].y);
    glVertex2d(lower[i].x, lower[i].y);
  }
  glEnd();
}

void GlCanvas::triangles(std::span<const Vertex> vertices) {
  glBegin(GL_TRIANGLES);
  for (const Vertex& v : vertices) {
    set_colour(v.colour);
    glVertex2d(v.at.x, v.at.y);
  }
  glEnd();
}

const GlCanvas::Glyph& GlCanvas::glyph(int face, unsigned index, double pixels) {
  const auto [slot, is_new] = glyphs_.try_emplace({face, index, static_cast<int>(std::lround(pixels * 64))});
  Glyph& result = slot->second;
  if (!is_new) return result;
  const GlyphBitmap bitmap = FontSet::of_this_thread().rasterise(face, index, pixels);
  // The bitmap has one clear texel all round, so that filtering at the edge of a turned glyph finds nothing to smear.
  result = {0, bitmap.width + 2, bitmap.height + 2, bitmap.left - 1, bitmap.top + 1};
  std::vector<std::uint8_t> padded(static_cast<std::size_t>(result.width) * result.height, 0);
  for (int row = 0; row < bitmap.height; ++row) {
    std::copy_n(bitmap.coverage.begin() + static_cast<std::ptrdiff_t>(row) * bitmap.width, bitmap.width,
                padded.begin() + static_cast<std::ptrdiff_t>(row + 1) * result.width + 1);
  }
  glGenTextures(1, &result.texture);
  glBindTexture(GL_TEXTURE_2D, result.texture);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_ALPHA, result.width, result.height, 0, GL_ALPHA, GL_UNSIGNED_BYTE, padded.data());
  return result;
}

void GlCanvas::text(Point at, std::string_view utf8, const TextStyle& style) {
  const double width = measure_text(utf8, style.size, style.bold);
  double pen = style.anchor == Anchor::start ? 0 : style.anchor == Anchor::middle ? -width / 2 : -width;
  const double base = style.baseline == Baseline::alphabetic ? 0
                      : style.baseline == Baseline::middle   ? kCapHeight * style.size / 2
                                                             : kCapHeight * style.size;
  glPushMatrix();
  // Upright text starts on a whole sample, so that every line of text is equally sharp.
  const auto snap = [&](double v) { return style.rotation == 0 ? std::round(v * samples_) / samples_ : v; };
  glTranslated(snap(at.x), snap(at.y + (style.rotation == 0 ? base : 0)), 0);
  glRotated(-style.rotation, 0, 0, 1);
  if (style.rotation != 0) glTranslated(0, base, 0);
  glEnable(GL_TEXTURE_2D);
  for (const GlyphPlace& place : FontSet::of_this_thread().place(utf8, style.bold)) {
    const Glyph& g = glyph(place.face, place.glyph, place.scale * style.size * samples_);
    glBindTexture(GL_TEXTURE_2D, g.texture);
    set_colour(style.colour);
    const double s = 1.0 / samples_, x = snap(pen) + g.left * s, y = snap(-place.rise * style.size) - g.top * s;
    glBegin(GL_TRIANGLE_STRIP);
    glTexCoord2d(0, 0), glVertex2d(x, y);
    glTexCoord2d(1, 0), glVertex2d(x + g.width * s, y);
    glTexCoord2d(0, 1), glVertex2d(x, y + g.height * s);
    glTexCoord2d(1, 1), glVertex2d(x + g.width * s, y + g.height * s);
    glEnd();
    pen += place.advance * style.size;
  }
  glDisable(GL_TEXTURE_2D);
  glPopMatrix();
}

void GlCanvas::clip(const Box& box) {
  const auto device = [&](double v, double origin) { return static_cast<int>(std::lround((v - origin) * samples_)); };
  const int x0 = std::clamp(device(box.x0, tile_.x0), 0, context_.width());
  const int x1 = std::clamp(device(box.x1, tile_.x0), 0, context_.width());
  const int y0 = std::clamp(device(box.y0, tile_.y0), 0, context_.height());
  const int y1 = std::clamp(device(box.y1, tile_.y0), 0, context_.height());
  glEnable(GL_SCISSOR_TEST);
  glScissor(x0, context_.height() - y1, x1 - x0, y1 - y0);
}

void GlCanvas::unclip() {
  glDisable(GL_SCISSOR_TEST);
}

void GlCanvas::lit_quadrilateral(const std::array<DistantPoint, 4>& corners, const Colour& colour, int size,
                                 std::span<const float> brightness) {
  constexpr double across[4] = {0, 1, 1, 0}, along[4] = {0, 0, 1, 1};
  unsigned texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_LUMINANCE, size, size, 0, GL_LUMINANCE, GL_FLOAT, brightness.data());
  glEnable(GL_TEXTURE_2D);
  glDisable(GL_BLEND);
  set_colour(colour);
  glBegin(GL_QUADS);
  for (std::size_t k = 0; k < 4; ++k) {
    const double near = 1 / corners[k].ahead;
    glTexCoord4d(across[k] * near, along[k] * near, 0, near);  // divided by the last for each sample: perspective
    glVertex2d(corners[k].at.x, corners[k].at.y);
  }
  glEnd();
  glEnable(GL_BLEND);
  glDisable(GL_TEXTURE_2D);
  glDeleteTextures(1, &texture);
}

TileSamples GlCanvas::finished() {
  context_.finish();
  return {tile_, samples_, context_.width(), context_.height(), context_.pixels()};
}

Image GlCanvas::resolve() {
  context_.finish();
  return mean_of(context_.pixels(), context_.width(), context_.height(), samples_);
}

Image rasterise(int width, int height, int samples, const std::function<void(GlCanvas&)>& draw,
                const std::function<void(const TileSamples&)>& paint) {
  const auto tile = [&](int x0, int y0, int x1, int y1) {
    GlCanvas canvas({double(x0), double(y0), double(x1), double(y1)}, samples);
    draw(canvas);
    if (paint) paint(canvas.finished());
    return canvas.resolve();
  };
  if (width <= kLargestTile && height <= kLargestTile) return tile(0, 0, width, height);
  Image whole(width, height);
  for (int y = 0; y < height; y += kLargestTile) {
    for (int x = 0; x < width; x += kLargestTile) {
      const Image part = tile(x, y, std::min(x + kLargestTile, width), std::min(y + kLargestTile, height));
      for (int row = 0; row < part.height; ++row) {
        std::copy_n(part.at(0, row), static_cast<std::size_t>(part.width) * 3, whole.at(x, y + row));
      }
    }
  }
  return whole;
}

}  // namespace mpm::render
