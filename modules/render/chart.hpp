// What all charts share: the page, axes, and labels that keep out of each other's way.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/canvas.hpp"
#include "render/numbers.hpp"

namespace mpm::render {

/// Sizes in pixels, in proportion to the picture's height.
struct Theme {
  double width = 0, height = 0;
  double unit = 1;  ///< one pixel of a picture 1000 high
  double text = 0;  ///< never below 1/45 of the height
  double title = 0;
  double margin = 0;

  TextStyle style(const Colour& colour = kInk, Anchor anchor = Anchor::start,
                  Baseline baseline = Baseline::alphabetic) const {
    return {text, colour, anchor, baseline};
  }
};

Theme theme_for(int width, int height);

/// Breaks the text at spaces so that each line is at most `width` pixels; a longer word keeps a line of its own.
std::vector<std::string> wrapped(const Canvas& canvas, std::string_view text, double size, double width,
                                 bool bold = false);

/// Draws the title at the top left and the footnote at the foot; returns the space that is left.
Box draw_page(Canvas& canvas, const Theme& theme, const std::string& title, const std::string& footnote);

/// A value axis: data range and its marks.
struct Axis {
  double lo = 0, hi = 1;
  bool is_log = false;
  double linear_within = 0;  ///< of a logarithmic axis: above zero both signs stand, and it is linear around zero
  Ticks ticks;
  /// The value's place along the axis: 0 at lo, 1 at hi.
  double fraction(double value) const;
};

/// The smallest and largest of many values; empty until the first finite one.
struct Range {
  std::optional<double> lo, hi;
  void add(double value);
};

/// A range with air at both ends. `pad` is a fraction of the span; a constant gets a span of its own. With `zero` the
/// range reaches to zero when that is near. `count` is how many numbers fit along the axis.
Axis make_axis(const Range& range, bool is_log, double pad, bool zero, int count);

/// An axis of both signs, linear within `linear` (> 0) and logarithmic beyond.
Axis make_signed_log_axis(const Range& range, double linear, double pad, int count);

/// Places values in a box of pixels.
struct Scales {
  Box box;
  Axis x, y;
  Point at(double x_value, double y_value) const {
    return {box.x0 + x.fraction(x_value) * box.width(), box.y1 - y.fraction(y_value) * box.height()};
  }
};

/// The widest number of a vertical axis, pixels.
double widest_label(const Canvas& canvas, const Theme& theme, const Ticks& ticks);

/// Draws the value grid, numbers, axis names and the zero line where the sign matters.
void draw_axes(Canvas& canvas, const Theme& theme, const Scales& scales, const std::string& x_label,
               const std::string& y_label, double label_left, bool show_x_numbers = true);

/// Draws value grid and zero line without the axes' names; numbers where asked for.
void draw_scales(Canvas& canvas, const Theme& theme, const Scales& scales, bool show_x_numbers, bool show_y_numbers);

/// The text, or as much of its beginning as fits `width` with "…" after it.
std::string shortened(const Canvas& canvas, std::string_view text, double size, double width, bool bold = false);

/// Moves intervals along a line as little as possible so that none overlap, within [lo, hi]. `centres` are the wanted
/// centres, `sizes` the lengths. Returns the new centres, or nothing when they cannot all fit.
std::optional<std::vector<double>> spread(std::span<const double> centres, std::span<const double> sizes, double lo,
                                          double hi);

/// A name at the right of a chart, tied to the point where its line ends.
struct EndLabel {
  std::string text;
  Colour colour;
  Point end;
  std::function<void(Canvas&, Point, double)> sample = {};  ///< draws the line's mark at a point, given a radius
};

/// Pixels to keep free at the right for end labels, or nothing when they are too wide or too many for the height.
std::optional<double> end_label_room(const Canvas& canvas, const Theme& theme, std::span<const std::string> texts,
                                     double height);

/// The vertical boxes of the labels right of `box`, in the order given, free of overlap.
std::vector<Box> end_label_boxes(const Canvas& canvas, const Theme& theme, std::span<const EndLabel> labels,
                                 const Box& box);

void draw_end_labels(Canvas& canvas, const Theme& theme, std::span<const EndLabel> labels, const Box& box);

/// An entry of a legend; `sample` draws the mark of the series into the box.
struct LegendEntry {
  std::string text;
  std::function<void(Canvas&, const Box&)> sample;
  bool is_wide = true;  ///< a line needs more room than a mark
};

/// Lays entries out in rows from the top of `space`; returns the height used, and draws when `canvas_to_draw` is given.
double lay_legend(const Canvas& canvas, const Theme& theme, std::span<const LegendEntry> entries, const Box& space,
                  Canvas* canvas_to_draw);

/// Writes stem + extension, whole or not at all; not synced to the disk, because a figure can be drawn again. Throws
/// support::MachineError.
void write_part(const std::filesystem::path& stem, std::string_view extension, std::string_view bytes);

/// Draws the same layout as STEM.png and, when `with_svg`, STEM.svg; writes `csv` as STEM.csv. Throws
/// support::MachineError when a file cannot be written.
void write_all(const std::filesystem::path& stem, int width, int height, const std::string& title,
               const std::string& csv, const std::function<void(Canvas&)>& draw, bool with_svg = true);

/// Throws std::invalid_argument unless both are between 64 and 32768 pixels.
void check_size(int width, int height);

/// The count with its noun and a remark: "3 points not finite, left out"; empty when n is 0.
std::string counted(std::size_t n, const std::string& noun, const std::string& what);

/// Dash pattern of the k-th black line: solid, dashed, then dotted.
std::vector<double> solid_or_dashed(std::size_t k, double unit);

/// Joins two remarks with a middle dot; either may be empty.
std::string joined(const std::string& a, const std::string& b);

}  // namespace mpm::render
