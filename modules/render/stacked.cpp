// The ledger: areas by cause above and below zero, and a panel of its own for the residual.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "render/chart.hpp"
#include "render/plot.hpp"
#include "render/polyline.hpp"
#include "support/csv.hpp"
#include "support/numbers.hpp"

namespace mpm::render {
namespace {

void check(const StackedPlot& plot) {
  check_size(plot.width, plot.height);
  for (const auto* list : {&plot.areas, &plot.lines}) {
    for (const Series& s : *list) {
      if (s.y.size() == plot.x.size()) continue;
      throw std::invalid_argument("series '" + s.label + "': " + std::to_string(s.y.size()) + " values, but " +
                                  std::to_string(plot.x.size()) + " values of x");
    }
  }
}

/// The rows in which every number is finite, ordered as x.
std::vector<std::size_t> finite_rows(const StackedPlot& plot) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < plot.x.size(); ++i) {
    bool is_finite = std::isfinite(plot.x[i]);
    for (const auto* list : {&plot.areas, &plot.lines}) {
      for (const Series& s : *list) is_finite &= std::isfinite(s.y[i]);
    }
    if (is_finite) rows.push_back(i);
  }
  std::stable_sort(rows.begin(), rows.end(), [&](auto a, auto b) { return plot.x[a] < plot.x[b]; });
  return rows;
}

/// An area of one cause between two curves, in the data's units.
struct Layer {
  std::vector<double> from, to;
  Colour colour;
  int hatch = 0;
};

std::vector<Layer> stack(const StackedPlot& plot, const std::vector<std::size_t>& rows) {
  std::vector<double> above(rows.size(), 0), below(rows.size(), 0);
  std::vector<Layer> layers;
  for (std::size_t k = 0; k < plot.areas.size(); ++k) {
    Layer layer{{}, {}, palette(k), static_cast<int>(k % 5)};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double value = plot.areas[k].y[rows[i]];
      double& edge = value < 0 ? below[i] : above[i];
      layer.from.push_back(edge);
      edge += value;
      layer.to.push_back(edge);
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

double interpolated(std::span<const Point> line, double x) {
  const auto right = std::lower_bound(line.begin(), line.end(), x, [](const Point& p, double v) { return p.x < v; });
  if (right == line.begin()) return line.front().y;
  if (right == line.end()) return line.back().y;
  const Point a = *(right - 1), b = *right;
  return b.x > a.x ? a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x) : b.y;
}

/// Hatches an area as its second cue: white strokes of a direction of its own, cut where they leave the band.
void hatch(Canvas& canvas, std::span<const Point> upper, std::span<const Point> lower, int pattern, double u) {
  constexpr double slopes[] = {0, 1, -1, 0, 2.5};
  if (pattern == 0) return;
  const double slope = slopes[pattern], spacing = 20 * u * std::hypot(1, slope), step = 2 * u;
  const double x0 = upper.front().x, x1 = upper.back().x;
  double top = upper[0].y, bottom = upper[0].y;
  for (const auto& line : {upper, lower}) {
    for (const Point& p : line) top = std::min(top, p.y), bottom = std::max(bottom, p.y);
  }
  const double reach = std::fabs(slope) * (x1 - x0);
  for (double start = std::floor((top - reach) / spacing) * spacing; start < bottom + reach; start += spacing) {
    std::vector<Point> piece;
    const auto flush = [&] {
      if (piece.size() > 1) canvas.line(piece.front(), piece.back(), {{1, 1, 1, 0.55}, 2 * u});
      piece.clear();
    };
    for (double x = x0; x <= x1; x += step) {
      const double y = start + slope * (x - x0), a = interpolated(upper, x), b = interpolated(lower, x);
      if (y > std::min(a, b) && y < std::max(a, b))
        piece.push_back({x, y});
      else
        flush();
    }
    flush();
  }
}

void draw_layer(Canvas& canvas, const Scales& s, const std::vector<double>& x, const Layer& layer, double u) {
  // More columns than pixels cannot be seen.
  const std::size_t stride = std::max<std::size_t>(1, x.size() / 3000);
  std::vector<Point> upper, lower;
  for (std::size_t i = 0; i < x.size(); i = i + 1 < x.size() ? std::min(i + stride, x.size() - 1) : x.size()) {
    upper.push_back(s.at(x[i], layer.to[i]));
    lower.push_back(s.at(x[i], layer.from[i]));
  }
  canvas.band(upper, lower, layer.colour);
  hatch(canvas, upper, lower, layer.hatch, u);
  canvas.polyline(thinned(upper), {kWhite, 1.5 * u});
}

/// A swatch with the area's colour and hatch.
void draw_swatch(Canvas& canvas, const Box& box, const Layer& layer, double u) {
  const std::vector<Point> upper{{box.x0, box.y0}, {box.x1, box.y0}}, lower{{box.x0, box.y1}, {box.x1, box.y1}};
  canvas.band(upper, lower, layer.colour);
  hatch(canvas, upper, lower, layer.hatch, 0.45 * u);
}

std::string unit_of(const std::string& label) {
  const auto open = label.rfind('(');
  return open == std::string::npos ? "" : " " + label.substr(open);
}

void draw_residual(Canvas& canvas, const Theme& theme, const StackedPlot& plot, const std::vector<std::size_t>& rows,
                   const std::vector<double>& x, Scales s, double label_left) {
  Range range;
  for (const Series& line : plot.lines) {
    for (const std::size_t row : rows) range.add(line.y[row]);
  }
  range.add(0);
  s.y = make_axis(range, false, 0.08, false, 3);
  std::string name;
  for (const Series& line : plot.lines) name += (name.empty() ? "" : ", ") + line.label;
  draw_axes(canvas, theme, s, plot.x_label, name + ", drawn apart" + unit_of(plot.y_label), label_left);
  std::vector<EndLabel> labels;
  for (std::size_t k = 0; k < plot.lines.size(); ++k) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < rows.size(); ++i) points.push_back(s.at(x[i], plot.lines[k].y[rows[i]]));
    if (points.empty()) continue;
    canvas.polyline(thinned(points), {kBlack, 2.4 * theme.unit, solid_or_dashed(k, theme.unit)});
    labels.push_back({plot.lines[k].label, kBlack, points.back(), [k, &theme](Canvas& c, Point at, double radius) {
                        c.line({at.x - radius, at.y}, {at.x + radius, at.y},
                               {kBlack, 2.4 * theme.unit, solid_or_dashed(k, theme.unit * 0.4)});
                      }});
  }
  const bool is_named_above = plot.lines.size() == 1;
  if (!is_named_above && s.box.x1 < theme.width - 2 * theme.margin) draw_end_labels(canvas, theme, labels, s.box);
}

Scales scales_of(const std::vector<double>& x, const std::vector<Layer>& layers, const Theme& theme) {
  Range x_range, y_range;
  for (const double value : x) x_range.add(value);
  for (const Layer& layer : layers) {
    for (const double value : layer.to) y_range.add(value);
  }
  y_range.add(0);
  Scales s;
  s.x = make_axis(x_range, false, 0, false, std::clamp(static_cast<int>(theme.width / theme.text / 7), 2, 9));
  s.y = make_axis(y_range, false, 0.05, true, std::clamp(static_cast<int>(theme.height / theme.text / 7), 2, 7));
  return s;
}

/// Writes the name of each cause, tied to the middle of its area's right end.
void name_layers(Canvas& canvas, const Theme& theme, const StackedPlot& plot, const std::vector<Layer>& layers,
                 double last_x, const Scales& s) {
  std::vector<EndLabel> labels;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const double middle = (layers[k].from.back() + layers[k].to.back()) / 2;
    labels.push_back(
        {plot.areas[k].label, layers[k].colour, s.at(last_x, middle), [&, k](Canvas& c, Point at, double r) {
           draw_swatch(c, {at.x - 1.3 * r, at.y - r, at.x + 1.3 * r, at.y + r}, layers[k], theme.unit);
         }});
  }
  draw_end_labels(canvas, theme, labels, s.box);
}

void draw_stacked(Canvas& canvas, const StackedPlot& plot, const Theme& theme, const std::vector<std::size_t>& rows) {
  const std::string remark = counted(plot.x.size() - rows.size(), "row", "with a value that is not finite, left out");
  const Box page = draw_page(canvas, theme, plot.title, joined(plot.footnote, remark));
  const auto layers = stack(plot, rows);
  std::vector<double> x;
  for (const std::size_t row : rows) x.push_back(plot.x[row]);
  Scales s = scales_of(x, layers, theme);

  std::vector<std::string> names;
  for (const auto* list : {&plot.areas, &plot.lines}) {
    for (const Series& series : *list) names.push_back(series.label);
  }
  const double below = 16 * theme.unit + 2.6 * theme.text;
  const double space = page.height() - below - 2.4 * theme.text;
  const double panel = plot.lines.empty() ? 0 : 0.22 * space;
  const auto room = rows.empty() ? std::nullopt : end_label_room(canvas, theme, names, space - panel);
  std::vector<LegendEntry> legend;
  for (std::size_t k = 0; k < layers.size() && !room; ++k) {
    legend.push_back(
        {plot.areas[k].label, [&, k](Canvas& c, const Box& box) { draw_swatch(c, box, layers[k], theme.unit); }});
  }
  const double top = page.y0 + lay_legend(canvas, theme, legend, page, &canvas) + 2.4 * theme.text;
  const double left = page.x0 + std::max(widest_label(canvas, theme, s.y.ticks), 3.2 * theme.text) + 12 * theme.unit;
  const double right = page.x1 - room.value_or(theme.text), foot = page.y1 - below;
  s.box = {left, top, right, plot.lines.empty() ? foot : foot - panel - 2.6 * theme.text};
  draw_axes(canvas, theme, s, plot.x_label, plot.y_label, page.x0, plot.lines.empty());
  if (rows.empty()) canvas.text(s.box.centre(), "no data to show", theme.style(kQuiet, Anchor::middle));
  if (rows.empty()) return;
  for (const Layer& layer : layers) draw_layer(canvas, s, x, layer, theme.unit);
  canvas.line(s.at(s.x.lo, 0), s.at(s.x.hi, 0), {kInk, 2 * theme.unit});

  if (room) name_layers(canvas, theme, plot, layers, x.back(), s);
  if (!plot.lines.empty())
    draw_residual(canvas, theme, plot, rows, x, {{left, foot - panel, right, foot}, s.x, {}}, page.x0);
}

std::string table_of(const StackedPlot& plot, const std::vector<std::size_t>& rows) {
  support::CsvText csv;
  std::vector<std::string> cells{plot.x_label};
  for (const auto* list : {&plot.areas, &plot.lines}) {
    for (const Series& s : *list) cells.push_back(s.label + unit_of(plot.y_label));
  }
  csv.row(cells);
  for (const std::size_t row : rows) {
    cells = {support::full_precision(plot.x[row])};
    for (const auto* list : {&plot.areas, &plot.lines}) {
      for (const Series& s : *list) cells.push_back(support::full_precision(s.y[row]));
    }
    csv.row(cells);
  }
  return csv.text();
}

}  // namespace

void write_figure(const StackedPlot& plot, const std::filesystem::path& stem) {
  check(plot);
  const Theme theme = theme_for(plot.width, plot.height);
  const auto rows = finite_rows(plot);
  write_all(stem, plot.width, plot.height, plot.title, table_of(plot, rows),
            [&](Canvas& canvas) { draw_stacked(canvas, plot, theme, rows); });
}

}  // namespace mpm::render
