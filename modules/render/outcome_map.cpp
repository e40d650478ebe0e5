// The map of stability: cells by outcome, theoretical limits over them.
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

constexpr Colour kNotRun{0.92, 0.92, 0.92};
constexpr Marker kSigns[] = {Marker::circle, Marker::cross,   Marker::square,       Marker::triangle,
                             Marker::plus,   Marker::diamond, Marker::down_triangle};

void check_axis(const char* name, const std::vector<double>& values, bool is_log) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool is_good =
        std::isfinite(values[i]) && (!is_log || values[i] > 0) && (i == 0 || values[i] > values[i - 1]);
    if (!is_good) {
      throw std::invalid_argument(std::string("the map's values of ") + name +
                                  " must increase, be finite and, on a logarithmic axis, positive");
    }
  }
}

void check(const OutcomeMap& map) {
  check_size(map.width, map.height);
  check_axis("x", map.x, map.log_x);
  check_axis("y", map.y, map.log_y);
  if (map.outcome.size() != map.x.size() * map.y.size()) {
    throw std::invalid_argument("a map of " + std::to_string(map.x.size()) + " x " + std::to_string(map.y.size()) +
                                " cells has " + std::to_string(map.outcome.size()) + " outcomes");
  }
  if (!map.y_names.empty() && map.y_names.size() != map.y.size()) {
    throw std::invalid_argument("a map of " + std::to_string(map.y.size()) + " rows has " +
                                std::to_string(map.y_names.size()) + " names for them");
  }
  for (const int k : map.outcome) {
    if (k >= -1 && k < static_cast<int>(map.outcomes.size())) continue;
    throw std::invalid_argument("the map has an outcome " + std::to_string(k) + " without a name");
  }
  for (const Series& s : map.limits) {
    if (s.x.size() != s.y.size()) throw std::invalid_argument("limit '" + s.label + "': x and y differ in length");
  }
}

/// The borders of cells: half way between the centres, in the axis' own measure.
std::vector<double> borders(const std::vector<double>& centres, bool is_log) {
  const auto in = [&](double v) { return is_log ? std::log(v) : v; };
  const auto out = [&](double v) { return is_log ? std::exp(v) : v; };
  const std::size_t n = centres.size();
  if (n == 0) return {};
  const double alone = is_log ? 0.5 : std::max(0.5 * std::fabs(centres[0]), 0.5);
  const double first = n > 1 ? (in(centres[1]) - in(centres[0])) / 2 : alone;
  const double last = n > 1 ? (in(centres[n - 1]) - in(centres[n - 2])) / 2 : alone;
  std::vector<double> result{out(in(centres[0]) - first)};
  for (std::size_t i = 0; i + 1 < n; ++i) result.push_back(out((in(centres[i]) + in(centres[i + 1])) / 2));
  result.push_back(out(in(centres[n - 1]) + last));
  return result;
}

/// The outcome's colour, lightened so that the mark and the limits stay readable upon it.
Colour cell_colour(int outcome) {
  return outcome < 0 ? kNotRun : mix(kWhite, palette(static_cast<std::size_t>(outcome)), 0.75);
}

void draw_cell(Canvas& canvas, const Box& box, int outcome, double radius) {
  canvas.rectangle(box, cell_colour(outcome));
  if (outcome < 0) return;
  const Colour sign = mix(palette(static_cast<std::size_t>(outcome)), kBlack, 0.45);
  canvas.marker(box.centre(), kSigns[static_cast<std::size_t>(outcome) % std::size(kSigns)], radius, sign, {sign, 0});
}

void draw_limits(Canvas& canvas, const Theme& theme, const OutcomeMap& map, const Scales& s) {
  canvas.clip(s.box);
  for (std::size_t k = 0; k < map.limits.size(); ++k) {
    std::vector<Point> line;
    for (std::size_t i = 0; i < map.limits[k].x.size(); ++i) {
      const double x = map.limits[k].x[i], y = map.limits[k].y[i];
      const bool is_shown = std::isfinite(x) && std::isfinite(y) && (!map.log_x || x > 0) && (!map.log_y || y > 0);
      if (is_shown) line.push_back(s.at(x, y));
    }
    // A white rim keeps black readable on the darker cells.
    canvas.polyline(line, {kWhite, 7 * theme.unit});
    canvas.polyline(line, {kBlack, 3 * theme.unit, solid_or_dashed(k, theme.unit)});
  }
  canvas.unclip();
}

Axis cell_axis(const std::vector<double>& edges, bool is_log, int count) {
  Range range;
  for (const double edge : edges) range.add(edge);
  return make_axis(range, is_log, 0, false, count);
}

std::vector<LegendEntry> legend_of(const OutcomeMap& map, const Theme& theme) {
  std::vector<LegendEntry> entries;
  const auto add_cell = [&](const std::string& name, int outcome) {
    entries.push_back(
        {name, [outcome, &theme](Canvas& c, const Box& b) { draw_cell(c, b, outcome, 0.24 * theme.text); }, false});
  };
  for (int k = 0; k < static_cast<int>(map.outcomes.size()); ++k)
    if (std::count(map.outcome.begin(), map.outcome.end(), k) > 0)
      add_cell(map.outcomes[static_cast<std::size_t>(k)], k);
  if (std::count(map.outcome.begin(), map.outcome.end(), -1) > 0) add_cell("not run", -1);
  for (std::size_t k = 0; k < map.limits.size(); ++k) {
    entries.push_back(
        {map.limits[k].label, [k, &theme](Canvas& c, const Box& b) {
           c.line({b.x0, b.centre().y}, {b.x1, b.centre().y}, {kBlack, 3 * theme.unit, solid_or_dashed(k, theme.unit)});
         }});
  }
  return entries;
}

void draw_map(Canvas& canvas, const OutcomeMap& map, const Theme& theme) {
  const Box page = draw_page(canvas, theme, map.title, map.footnote);
  const auto legend = legend_of(map, theme);
  const double legend_height = lay_legend(canvas, theme, legend, page, &canvas);
  const auto x = borders(map.x, map.log_x), y = borders(map.y, map.log_y);
  Scales s{{}, cell_axis(x, map.log_x, 8), cell_axis(y, map.log_y, 7)};
  if (!map.y_names.empty()) s.y.ticks = {map.y, {}, map.y_names, 0};
  const double left = page.x0 + widest_label(canvas, theme, s.y.ticks) + 12 * theme.unit;
  s.box = {left, page.y0 + legend_height + 2.4 * theme.text, page.x1 - theme.text,
           page.y1 - 16 * theme.unit - 2.6 * theme.text};
  draw_axes(canvas, theme, s, map.x_label, map.y_label, page.x0);
  for (std::size_t j = 0; j < map.y.size(); ++j) {
    for (std::size_t i = 0; i < map.x.size(); ++i) {
      const Point a = s.at(x[i], y[j + 1]), b = s.at(x[i + 1], y[j]);
      const double gap = std::min(1.5 * theme.unit, (b.x - a.x) / 10), small = std::min(b.x - a.x, b.y - a.y);
      draw_cell(canvas, {a.x + gap, a.y + gap, b.x - gap, b.y - gap}, map.outcome[j * map.x.size() + i],
                std::min(0.2 * small, 9 * theme.unit));
    }
  }
  draw_limits(canvas, theme, map, s);
  if (map.outcome.empty()) canvas.text(s.box.centre(), "no data to show", theme.style(kQuiet, Anchor::middle));
}

std::string table_of(const OutcomeMap& map) {
  support::CsvText csv;
  csv.row({"what", map.x_label, map.y_label});
  for (std::size_t j = 0; j < map.y.size(); ++j) {
    for (std::size_t i = 0; i < map.x.size(); ++i) {
      const int k = map.outcome[j * map.x.size() + i];
      csv.row({k < 0 ? "not run" : map.outcomes[static_cast<std::size_t>(k)], support::full_precision(map.x[i]),
               support::full_precision(map.y[j])});
    }
  }
  for (const Series& s : map.limits) {
    for (std::size_t i = 0; i < s.x.size(); ++i)
      csv.row({s.label, support::full_precision(s.x[i]), support::full_precision(s.y[i])});
  }
  return csv.text();
}

}  // namespace

void write_figure(const OutcomeMap& map, const std::filesystem::path& stem) {
  check(map);
  const Theme theme = theme_for(map.width, map.height);
  write_all(stem, map.width, map.height, map.title, table_of(map),
            [&](Canvas& canvas) { draw_map(canvas, map, theme); });
}

}  // namespace mpm::render
