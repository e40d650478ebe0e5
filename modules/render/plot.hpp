// Curves, points, areas, maps and small multiples as figures: STEM.png, STEM.svg and STEM.csv with exactly what is
// shown.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mpm::render {

/// How a series is drawn. computed: coloured line with markers; exact: thin black line; published: black open markers
/// with error bars; point: coloured markers only.
enum class SeriesKind { computed, exact, published, point };

/// x and y have equally many values; `error` is empty or holds the half length of each point's error bar, in y's unit.
struct Series {
  std::string label = {};
  std::vector<double> x = {}, y = {};
  std::vector<double> error = {};
  SeriesKind kind = SeriesKind::computed;
  std::vector<std::string> point_labels = {};  ///< optional: a short name beside each point
  std::vector<std::string> point_names = {};   ///< optional, in the table alone: what each point is
  std::vector<std::string> dominated_by = {};  ///< optional, in the table alone: the name of a point that is better
};

/// A named place along x, drawn as a thin upright line.
struct PlaceMark {
  double at = 0;
  std::string label = {};
};

/// Labels carry quantity, symbol and unit: "kinetic energy T (J)". Sizes are pixels.
struct Plot {
  std::string title = {}, x_label = {}, y_label = {}, footnote = {};
  bool log_x = false, log_y = false;
  std::vector<Series> series = {};
  bool slope_triangles = false;  ///< log-log only: the order fitted to each computed series, written on a triangle
  double linear_within = 0;      ///< of log_y: above zero, y has both signs and is linear within it
  std::vector<PlaceMark> marks = {};
  bool pareto_front = false;  ///< draws the front of least x and least y of all `point` series; the rest is faded
  int width = 1600, height = 1000;
};

/// Areas are laid upon one another by cause, positive values upwards from zero, negative ones downwards.
/// All y have as many values as `x`; the x of each series is not read.
struct StackedPlot {
  std::string title = {}, x_label = {}, y_label = {}, footnote = {};
  std::vector<double> x = {};
  std::vector<Series> areas = {};
  std::vector<Series> lines = {};  ///< drawn in black in a panel of their own, so that a small residual cannot hide
  int width = 1600, height = 1000;
};

/// A map of stability: one cell for each pair of x and y, coloured and marked by what became of the run.
struct OutcomeMap {
  std::string title = {}, x_label = {}, y_label = {}, footnote = {};
  std::vector<double> x = {}, y = {};     ///< centres of the cells, increasing
  std::vector<std::string> y_names = {};  ///< empty, or one a row: written in place of the numbers of y
  std::vector<int> outcome = {};          ///< y.size() rows of x.size(): index into `outcomes`, -1: nothing was run
  /// Words such as "bounded", "gained energy", "stopped: left the grid"; one without a cell keeps its colour for other
  /// maps.
  std::vector<std::string> outcomes = {};
  std::vector<Series> limits = {};  ///< theoretical limits, drawn over the cells in black
  bool log_x = false, log_y = false;
  int width = 1600, height = 1000;
};

/// A table of numbers as colours, one cell for each pair of categories, its number written in it.
struct HeatMap {
  std::string title = {}, x_label = {}, y_label = {}, value_label = {}, footnote = {};
  std::vector<std::string> x_names = {}, y_names = {};  ///< columns from the left, rows from the top
  std::vector<double> values = {};                      ///< y_names.size() rows of x_names.size(); NaN: not run
  std::vector<std::string> notes = {};  ///< empty, or one a cell: beside its number, or in place of "not run"
  bool log_scale = false;               ///< whether the colours follow the logarithm
  int digits = 3;                       ///< significant digits of the numbers in the cells
  int width = 1600, height = 1000;
};

/// One panel of small multiples.
struct Panel {
  std::string title = {};
  std::vector<Series> series = {};
};

/// Small multiples: a grid of panels with the same axes, so that they can be compared. Series of one label and kind
/// look alike in all panels and stand once in the legend.
struct Multiples {
  std::string title = {}, x_label = {}, y_label = {}, footnote = {};
  bool log_x = false, log_y = false;
  std::vector<Panel> panels = {};                      ///< row by row
  int columns = 0;                                     ///< 0: chosen so that panels are a little wider than high
  bool slope_triangles = false, pareto_front = false;  ///< as in Plot, for each panel
  int width = 1600, height = 1000;
};

/// Writes STEM.png, STEM.svg and STEM.csv; `stem` is a path without extension whose folder exists. Points that are not
/// finite, and on a logarithmic axis those that are not positive, are left out; the footnote says so. Throws
/// std::invalid_argument when array lengths or the size do not fit, and std::runtime_error naming path and cause when a
/// file cannot be written, or no font or GL context is there.
void write_figure(const Plot& plot, const std::filesystem::path& stem);
void write_figure(const StackedPlot& plot, const std::filesystem::path& stem);
void write_figure(const OutcomeMap& map, const std::filesystem::path& stem);
/// In a heat map a value that is not finite, or on a logarithmic scale not positive, is written without a colour.
void write_figure(const HeatMap& map, const std::filesystem::path& stem);
void write_figure(const Multiples& multiples, const std::filesystem::path& stem);

}  // namespace mpm::render
