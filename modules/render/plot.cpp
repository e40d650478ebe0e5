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

/// Upright lines at named places, each with its name beside its upper end; names that would overlap go below one another.
void draw_places(Canvas& canvas, const Theme& theme, const Scales& s, const std::vector<PlaceMark>& marks) {
  double row = 0, taken_to = -1e9;
  for (const PlaceMark& mark : marks) {
    const double along = s.x.fraction(mark.at);
    if (!(along >= 0 && along <= 1)) continue;
    const double x = s.at(mark.at, s.y.lo).x, gap = 0.4 * theme.text,
                 width = canvas.measure_text(mark.label, theme.text);
    const bool fits = x + gap + width <= s.box.x1;
    row = x < taken_to ? row + 1 : 0;
    taken_to = std::max(taken_to, x + gap + width);
    canvas.line({x, s.box.y0 + row * 1.35 * theme.text}, {x, s.box.y1},
                {kQuiet, 1.5 * theme.unit, {6 * theme.unit, 5 * theme.unit}});
    canvas.text({fits ? x + gap : x - gap, s.box.y0 + row * 1.35 * theme.text}, mark.label,
                theme.style(kQuiet, fits ? Anchor::start : Anchor::end, Baseline::top));
  }
}

void draw_plot(Canvas& canvas, const Plot& plot, const Theme& theme, Content& content) {
  std::string footnote = plot.footnote;
  const bool has_slopes = plot.slope_triangles && plot.log_x && plot.log_y;
  if (has_slopes) footnote = joined(footnote, "triangles: observed order, least squares over all points");
  const Box page = draw_page(canvas, theme, plot.title, joined(footnote, remark_of(content)));
  Scales s =
      axes_of({&content, 1}, plot.log_x, plot.log_y, std::clamp(static_cast<int>(theme.width / theme.text / 7), 2, 9),
              std::clamp(static_cast<int>(theme.height / theme.text / 6), 2, 8), plot.linear_within);

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