// What a plot and each panel of small multiples draw inside their axes: lines, marks, error bars, slopes, a front.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/chart.hpp"
#include "render/plot.hpp"

namespace mpm::render {

struct Look {
  Colour colour;
  Stroke line;  ///< width 0: no line
  Marker marker = Marker::circle;
  bool has_marker = false, is_hollow = false;
};

struct Shown {
  Series data;
  Look look;
  std::vector<bool> is_faded;  ///< Pareto: dominated
};

struct Content {
  std::vector<Shown> series;
  std::size_t not_finite = 0, not_positive = 0;  ///< points left out
  std::string empty;                             ///< names of series that nothing is left of
  bool has_long_lines = false;
};

/// The kind as a word: "computed", "exact", "published" or "point".
const char* name_of(SeriesKind kind);

/// Colour, dash and mark of each series by its turn among those of its kind. `u` is one pixel of the theme.
std::vector<Look> looks_of(std::span<const Series> series, double u);

/// Throws std::invalid_argument naming the series whose arrays differ in length.
void check_series(std::span<const Series> series);

/// The points that can be shown, in the order given. `looks` has one look a series; `positive_x` and `positive_y` leave
/// out what is not above zero.
Content select(std::span<const Series> series, std::span<const Look> looks, bool positive_x, bool positive_y);

/// Every point shown, a row each; with `panels` the panel's title is the first column. Names of points and what
/// dominates them have columns where a series has them.
std::string table_of(std::span<const Content> contents, const std::vector<std::string>& panels,
                     const std::string& x_label, const std::string& y_label);

/// What the footnote says of points that were left out.
std::string remark_of(const Content& content);

/// Axes that hold all of the contents. `count_x` and `count_y` are how many numbers fit along them; a logarithmic y is linear
/// within `linear_within` where that is above zero.
Scales axes_of(std::span<const Content> contents, bool log_x, bool log_y, int count_x, int count_y,
               double linear_within = 0);

/// The observed order: least squares of log y over log x. Nothing for an exact series, or where x does not vary. All
/// values must be positive.
std::optional<double> order_of(const Shown& shown);

/// What is drawn inside the axes. `labels_to` is how far to the right a point's label may reach.
struct CurveOptions {
  bool slopes = false, front = false;
  double labels_to = 0;
};
void draw_curves(Canvas& canvas, const Theme& theme, const Scales& scales, Content& content,
                 const CurveOptions& options);

void draw_mark(Canvas& canvas, const Look& look, Point at, double radius, double u, double strength = 1);

/// The legend's entry: a piece of the line with the mark on it. `shown` must outlive the entry.
LegendEntry legend_entry(const Shown& shown, double u);

}  // namespace mpm::render
