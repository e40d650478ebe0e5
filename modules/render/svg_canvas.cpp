#include "render/svg_canvas.hpp"

#include <vector>

#include "render/font.hpp"
#include "support/numbers.hpp"

namespace mpm::render {
namespace {

/// A number to a hundredth of a pixel, which is finer than any printer.
std::string number(double value) {
  const std::string text = support::without_trailing_zeros(support::fixed_point(value, 2));
  return text == "-0" ? "0" : text;
}

std::string attribute(std::string_view name, double value) {
  return " " + std::string(name) + "=\"" + number(value) + "\"";
}

}  // namespace

std::string xml_escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\n') result += c;
    }
  }
  return result;
}

SvgCanvas::SvgCanvas(int width, int height, std::string_view title) {
  const std::string w = std::to_string(width), h = std::to_string(height);
  body_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w +
          "\" height=\"" + h + "\" viewBox=\"0 0 " + w + " " + h +
          "\" font-family=\"'Open Sans', 'DejaVu Sans', sans-serif\">\n<title>" + xml_escaped(title) +
          "</title>\n<rect width=\"" + w + "\" height=\"" + h + "\" fill=\"#ffffff\"/>\n";
}

void SvgCanvas::points(std::span<const Point> list) {
  body_ += " points=\"";
  for (const Point& p : list) body_ += number(p.x) + "," + number(p.y) + " ";
  if (!list.empty()) body_.pop_back();
  body_ += '"';
}

void SvgCanvas::fill(const Colour& colour) {
  body_ += " fill=\"" + hex(colour) + "\"";
  if (colour.a < 1) body_ += attribute("fill-opacity", colour.a);
}

void SvgCanvas::polyline(std::span<const Point> list, const Stroke& stroke) {
  if (list.size() < 2 || stroke.width <= 0) return;
  body_ += "<polyline fill=\"none\" stroke=\"" + hex(stroke.colour) + "\"" + attribute("stroke-width", stroke.width);
  if (stroke.colour.a < 1) body_ += attribute("stroke-opacity", stroke.colour.a);
  if (!stroke.dash.empty()) {
    body_ += " stroke-dasharray=\"";
    for (const double length : stroke.dash) body_ += number(length) + " ";
    body_.back() = '"';
  }
  body_ += " stroke-linejoin=\"round\"";
  points(list);
  body_ += "/>\n";
}

void SvgCanvas::polygon(std::span<const Point> list, const Colour& colour) {
  body_ += "<polygon";
  fill(colour);
  points(list);
  body_ += "/>\n";
}

void SvgCanvas::band(std::span<const Point> upper, std::span<const Point> lower, const Colour& colour) {
  std::vector<Point> around(upper.begin(), upper.end());
  around.insert(around.end(), lower.rbegin(), lower.rend());
  polygon(around, colour);
}

void SvgCanvas::triangles(std::span<const Vertex> vertices) {
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3) {
    const Colour &a = vertices[i].colour, &b = vertices[i + 1].colour, &c = vertices[i + 2].colour;
    const Colour mean{(a.r + b.r + c.r) / 3, (a.g + b.g + c.g) / 3, (a.b + b.b + c.b) / 3, (a.a + b.a + c.a) / 3};
    polygon(std::array{vertices[i].at, vertices[i + 1].at, vertices[i + 2].at}, mean);
  }
}

void SvgCanvas::text(Point at, std::string_view utf8, const TextStyle& style) {
  const double drop = style.baseline == Baseline::alphabetic ? 0
                      : style.baseline == Baseline::middle   ? kCapHeight * style.size / 2
                                                             : kCapHeight * style.size;
  body_ += "<text" + attribute("font-size", style.size);
  fill(style.colour);
  if (style.bold) body_ += " font-weight=\"bold\"";
  if (style.anchor == Anchor::middle) body_ += " text-anchor=\"middle\"";
  if (style.anchor == Anchor::end) body_ += " text-anchor=\"end\"";
  if (style.rotation == 0) {
    body_ += attribute("x", at.x) + attribute("y", at.y + drop);
  } else {
    body_ += " transform=\"translate(" + number(at.x) + " " + number(at.y) + ") rotate(" + number(-style.rotation) +
             ")\"" + attribute("y", drop);
  }
  body_ += ">" + xml_escaped(utf8) + "</text>\n";
}

void SvgCanvas::clip(const Box& box) {
  unclip();
  const std::string id = "clip" + std::to_string(++clips_);
  body_ += "<clipPath id=\"" + id + "\"><rect" + attribute("x", box.x0) + attribute("y", box.y0) +
           attribute("width", box.width()) + attribute("height", box.height()) + "/></clipPath>\n<g clip-path=\"url(#" +
           id + ")\">\n";
  clipped_ = true;
}

void SvgCanvas::unclip() {
  if (clipped_) body_ += "</g>\n";
  clipped_ = false;
}

std::string SvgCanvas::document() const {
  return body_ + (clipped_ ? "</g>\n" : "") + "</svg>\n";
}

}  // namespace mpm::render
