#include "render/plot.hpp"

#include <algorithm>
#include <optional>

#include "render/chart.hpp"
#include "render/curves.hpp"

namespace mpm::render {
namespace {

bool ends_at_the_right(const Shown& shown, const Axis& axis) {
  const auto last = std::max_element(shown.data.x.begin(), shown.data.x.end());
  return axis.fraction(*last) > 0.85;
}

EndLabel end_label(const Shown& shown, const Scales& s, double u) {
  const auto last = std::max_element(shown.data.x.begin(), shown.data.x.end()) - shown.data.x.begin();
  return {shown.data.label, shown.look.colour, s.at(shown.data.x[last], shown.data.y[last]),
          [&shown, u](Canvas& canvas, Point at, double radius) {
            if (shown.look.has_marker) return draw_mark(canvas, shown.look, at, radius, u);
            canvas.line({at.x - 2 * radius, at.y}, {at.x + radius, at.y}, shown.look.line);
          }};
}

bool stands_within(const PlaceMark& mark, const Axis& axis) {
  const double along = axis.fraction(mark.at);
  return along >= 0 && along <= 1;
}

/// Upright lines at named places, each with its name beside its upper end; names that would overlap go below one another.
void draw_places(Canvas& canvas, const Theme& theme, const Scales& s, const std::vector<PlaceMark>& marks) {
  struct Taken {
    double from, to;
  };
  std::vector<std::vector<Taken>> rows;
  for (const PlaceMark& mark : marks) {
    if (!stands_within(mark, s.x)) continue;
    const double x = s.at(mark.at, s.y.lo).x, gap = 0.4 * theme.text;
    const std::string label = shortened(canvas, mark.label, theme.text, std::max(x - s.box.x0, s.box.x1 - x) - gap);
    const double width = canvas.measure_text(label, theme.text) + gap;
    const bool right = x + width <= s.box.x1;
    const Taken mine = right ? Taken{x, x + width} : Taken{x - width, x};
    const auto is_free = [&](const std::vector<Taken>& row) {
      return std::none_of(row.begin(), row.end(),
                          [&](const Taken& other) { return mine.from < other.to && other.from < mine.to; });
    };
    const auto found = std::find_if(rows.begin(), rows.end(), is_free);
    const auto row = static_cast<double>(found - rows.begin());
    if (found == rows.end())
      rows.push_back({mine});
    else
      found->push_back(mine);
    const double top = s.box.y0 + row * 1.35 * theme.text;
    canvas.line({x, top}, {x, s.box.y1}, {kQuiet, 1.5 * theme.unit, {6 * theme.unit, 5 * theme.unit}});
    canvas.text({right ? x + gap : x - gap, top}, label,
                theme.style(kQuiet, right ? Anchor::start : Anchor::end, Baseline::top));
  }
}

void draw_plot(Canvas& canvas, const Plot& plot, const Theme& theme, Content& content) {
  std::string footnote = plot.footnote;
  const bool has_slopes = plot.slope_triangles && plot.log_x && plot.log_y;
  if (has_slopes) footnote = joined(footnote, "triangles: observed order, least squares over all points");
  Scales s =
      axes_of({&content, 1}, plot.log_x, plot.log_y, std::clamp(static_cast<int>(theme.width / theme.text / 7), 2, 9),
              std::clamp(static_cast<int>(theme.height / theme.text / 6), 2, 8), plot.linear_within);
  const auto outside = static_cast<std::size_t>(std::count_if(
      plot.marks.begin(), plot.marks.end(), [&](const PlaceMark& mark) { return !stands_within(mark, s.x); }));
  footnote = joined(footnote, counted(outside, "mark", "outside the axis, left out"));
  const Box page = draw_page(canvas, theme, plot.title, joined(footnote, remark_of(content)));

  std::vector<std::string> names;
  bool all_end_right = true;
  for (const Shown& shown : content.series) {
    if (shown.data.label.empty()) continue;
    names.push_back(shown.data.label);
    all_end_right &= ends_at_the_right(shown, s.x);
  }
  const double below = 16 * theme.unit + 2.6 * theme.text;
  const auto room =
      all_end_right ? end_label_room(canvas, theme, names, page.height() - below - 2 * theme.text) : std::nullopt;
  std::vector<LegendEntry> legend;
  for (const Shown& shown : content.series) {
    if (!room && !shown.data.label.empty()) legend.push_back(legend_entry(shown, theme.unit));
  }
  const double legend_height = lay_legend(canvas, theme, legend, page, &canvas);

  const double left = page.x0 + widest_label(canvas, theme, s.y.ticks) + 12 * theme.unit;
  s.box = {left, page.y0 + legend_height + 2.4 * theme.text, page.x1 - (names.empty() ? 0 : room.value_or(theme.text)),
           page.y1 - below};
  draw_axes(canvas, theme, s, plot.x_label, plot.y_label, page.x0);

  draw_places(canvas, theme, s, plot.marks);
  draw_curves(canvas, theme, s, content, {has_slopes, plot.pareto_front, theme.width - theme.margin});
  if (!room) return;
  std::vector<EndLabel> labels;
  for (const Shown& shown : content.series) {
    if (!shown.data.label.empty()) labels.push_back(end_label(shown, s, theme.unit));
  }
  draw_end_labels(canvas, theme, labels, s.box);
}

}  // namespace

void write_figure(const Plot& plot, const std::filesystem::path& stem) {
  check_size(plot.width, plot.height);
  check_series(plot.series);
  const Theme theme = theme_for(plot.width, plot.height);
  Content content =
      select(plot.series, looks_of(plot.series, theme.unit), plot.log_x, plot.log_y && !(plot.linear_within > 0));
  write_all(stem, plot.width, plot.height, plot.title, table_of({&content, 1}, {}, plot.x_label, plot.y_label),
            [&](Canvas& canvas) { draw_plot(canvas, plot, theme, content); });
}

}  // namespace mpm::render