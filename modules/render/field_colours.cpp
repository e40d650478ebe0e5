#include "render/field_colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace mpm::render {
namespace {

constexpr int kStrips = 200;

std::string label_of(const ParticleFrame& frame) {
  return frame.unit.empty() ? frame.quantity : frame.quantity + " (" + frame.unit + ")";
}

}  // namespace

FieldColours::FieldColours(const ParticleFrame& frame, const std::vector<std::size_t>& shown)
    : map_(frame.map), label_(label_of(frame)), categories_(frame.categories) {
  Range seen;
  for (const std::size_t i : shown) seen.add(frame.values[i]);
  if (map_ == ColourMap::categorical) {
    const auto used = static_cast<std::size_t>(std::max(0.0, seen.hi.value_or(0)) + 1.5);
    while (categories_.size() < std::min<std::size_t>(used, 64)) {
      categories_.push_back("value " + std::to_string(categories_.size()));
    }
    return;
  }
  if (frame.range) {
    std::tie(lo_, hi_) = *frame.range;
    const double hair = 1e-9 * (hi_ - lo_);
    is_below_ = seen.lo && *seen.lo < lo_ - hair;
    is_above_ = seen.hi && *seen.hi > hi_ + hair;
  } else if (seen.lo) {
    lo_ = *seen.lo, hi_ = *seen.hi;
    if (lo_ > 0 && lo_ < 0.1 * hi_) lo_ = 0;  // a scale that all but starts at zero may as well say so
    if (map_ == ColourMap::diverging) hi_ = std::max(std::fabs(lo_), std::fabs(hi_)), lo_ = -hi_;
  }
  const double size = std::max(std::fabs(lo_), std::fabs(hi_));
  if (!(hi_ - lo_ > 1e-9 * size)) {
    // A single value sits in the middle of a scale wide enough to be numbered.
    const double half = size > 0 ? 0.1 * size : 1;
    const double centre = (lo_ + hi_) / 2;
    lo_ = centre - half, hi_ = centre + half;
  }
}

Colour FieldColours::operator()(double value) const {
  switch (map_) {
    case ColourMap::categorical:
      return palette(static_cast<std::size_t>(std::max(0L, std::lround(value))));
    case ColourMap::diverging:
      return diverging(value / std::max(std::fabs(lo_), std::fabs(hi_)));
    case ColourMap::viridis:
      break;
  }
  return viridis((value - lo_) / (hi_ - lo_));
}

Ticks FieldColours::ticks(const Theme& theme, double height) const {
  int count = std::clamp(static_cast<int>(height / theme.text / 4), 2, 8);
  Ticks marks = linear_ticks(lo_, hi_, count);
  // A single number gives no scale: a short bar gets closer marks.
  while (marks.labels.size() < 3 && count < 8) marks = linear_ticks(lo_, hi_, ++count);
  return marks;
}

std::vector<std::string> FieldColours::heading(const Canvas& canvas, const Theme& theme, double height) const {
  const int exponent = map_ == ColourMap::categorical ? 0 : ticks(theme, height).exponent;
  return wrapped(canvas, with_factor(label_, exponent), theme.text, 11 * theme.text);
}

double FieldColours::key_width(const Canvas& canvas, const Theme& theme, double height) const {
  double widest = 0;
  for (const auto& line : heading(canvas, theme, height))
    widest = std::max(widest, canvas.measure_text(line, theme.text));
  if (map_ == ColourMap::categorical) {
    for (const auto& name : categories_)
      widest = std::max(widest, canvas.measure_text(name, theme.text) + 1.6 * theme.text);
    return widest;
  }
  return std::max(widest, 1.9 * theme.text + widest_label(canvas, theme, ticks(theme, height)));
}

void FieldColours::draw_key(Canvas& canvas, const Theme& theme, const Box& box) const {
  double y = box.y0;
  for (const auto& line : heading(canvas, theme, box.height())) {
    canvas.text({box.x0, y}, line, theme.style(kInk, Anchor::start, Baseline::top));
    y += 1.3 * theme.text;
  }
  y += 0.4 * theme.text;
  if (map_ != ColourMap::categorical) return draw_bar(canvas, theme, {box.x0, y, box.x0 + 1.2 * theme.text, box.y1});
  for (std::size_t k = 0; k < categories_.size() && y + theme.text < box.y1; ++k, y += 1.5 * theme.text) {
    canvas.rectangle({box.x0, y, box.x0 + theme.text, y + theme.text}, palette(k));
    canvas.text({box.x0 + 1.6 * theme.text, y + theme.text / 2}, categories_[k],
                theme.style(kInk, Anchor::start, Baseline::middle));
  }
}

void FieldColours::draw_bar(Canvas& canvas, const Theme& theme, const Box& full) const {
  const double point = 0.9 * theme.text, air = 0.4 * theme.text;
  const Box bar{full.x0, full.y0 + (is_above_ ? point : air), full.x1, full.y1 - (is_below_ ? point : air)};
  const auto y_of = [&](double value) { return bar.y1 - (value - lo_) / (hi_ - lo_) * bar.height(); };
  for (int k = 0; k < kStrips; ++k) {
    const double middle = lo_ + (hi_ - lo_) * (k + 0.5) / kStrips;
    const double y = bar.y1 - bar.height() * k / kStrips, next = bar.y1 - bar.height() * (k + 1) / kStrips;
    // Each strip reaches under the one above, so that no seam shows between them.
    canvas.rectangle({bar.x0, std::max(next - 1, bar.y0), bar.x1, y}, (*this)(middle));
  }
  const double centre = bar.centre().x;
  if (is_above_)
    canvas.polygon(std::array<Point, 3>{{{bar.x0, bar.y0}, {bar.x1, bar.y0}, {centre, full.y0}}}, (*this)(hi_));
  if (is_below_)
    canvas.polygon(std::array<Point, 3>{{{bar.x0, bar.y1}, {bar.x1, bar.y1}, {centre, full.y1}}}, (*this)(lo_));
  std::vector<Point> edge{{bar.x0, bar.y0}, {bar.x0, bar.y1}};
  if (is_below_) edge.push_back({centre, full.y1});
  edge.insert(edge.end(), {{bar.x1, bar.y1}, {bar.x1, bar.y0}});
  if (is_above_) edge.push_back({centre, full.y0});
  edge.push_back(edge.front());
  canvas.polyline(edge, {kQuiet, theme.unit});
  const Ticks marks = ticks(theme, full.height());
  for (std::size_t i = 0; i < marks.major.size(); ++i) {
    const double y = y_of(marks.major[i]);
    canvas.line({bar.x1, y}, {bar.x1 + 7 * theme.unit, y}, {kQuiet, 1.5 * theme.unit});
    canvas.text({bar.x1 + 0.6 * theme.text, y}, marks.labels[i], theme.style(kInk, Anchor::start, Baseline::middle));
  }
}

}  // namespace mpm::render
