// Small multiples: panels with the same axes in a grid.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "render/chart.hpp"
#include "render/curves.hpp"
#include "render/plot.hpp"

namespace mpm::render {
namespace {

void check(const Multiples& m) {
  check_size(m.width, m.height);
  if (m.columns < 0)
    throw std::invalid_argument("small multiples cannot have " + std::to_string(m.columns) + " columns");
  for (const Panel& panel : m.panels) {
    try {
      check_series(panel.series);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("panel '" + panel.title + "', " + error.what());
    }
  }
}

/// What the panels show, and every look once.
struct Sheet {
  std::vector<Content> contents;  ///< one a panel
  std::vector<Shown> legend;
  std::string remark;
};

/// The series of all panels, each label and kind once.
std::vector<Series> distinct(const Multiples& m) {
  std::vector<Series> all;
  for (const Panel& panel : m.panels) {
    for (const Series& s : panel.series) {
      const bool is_known =
          std::any_of(all.begin(), all.end(), [&](const Series& t) { return t.label == s.label && t.kind == s.kind; });
      if (!is_known) all.push_back({s.label, {}, {}, {}, s.kind, {}});
    }
  }
  return all;
}

Sheet sheet_of(const Multiples& m, double unit) {
  Sheet sheet;
  const std::vector<Series> all = distinct(m);
  const std::vector<Look> looks = looks_of(all, unit);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!all[k].label.empty()) sheet.legend.push_back({all[k], looks[k], {}});
  }
  Content left_out;
  for (const Panel& panel : m.panels) {
    std::vector<Look> own;
    for (const Series& s : panel.series) {
      const auto same = [&](const Series& t) { return t.label == s.label && t.kind == s.kind; };
      own.push_back(looks[static_cast<std::size_t>(std::find_if(all.begin(), all.end(), same) - all.begin())]);
    }
    sheet.contents.push_back(select(panel.series, own, m.log_x, m.log_y));
    const Content& content = sheet.contents.back();
    left_out.not_finite += content.not_finite;
    left_out.not_positive += content.not_positive;
    if (content.empty.empty() || content.series.empty()) continue;  // a panel without any data says so itself
    left_out.empty += (left_out.empty.empty() ? "" : ", ") + content.empty + " (" + panel.title + ")";
  }
  sheet.remark = remark_of(left_out);
  return sheet;
}

struct Grid {
  std::size_t columns = 1, rows = 1;
};

/// The grid whose panels are a little wider than high and which leaves few places empty.
Grid grid_of(std::size_t panels, int columns, const Box& space) {
  const auto rows_for = [&](std::size_t c) { return (panels + c - 1) / c; };
  if (panels == 0) return {};
  if (columns > 0) return {static_cast<std::size_t>(columns), rows_for(static_cast<std::size_t>(columns))};
  Grid best;
  double best_cost = std::numeric_limits<double>::max();
  for (std::size_t c = 1; c <= panels; ++c) {
    const auto wide = static_cast<double>(c), high = static_cast<double>(rows_for(c));
    const double aspect = space.width() / wide / (space.height() / high);
    const double cost = std::fabs(std::log(aspect / 1.4)) + 0.8 * (wide * high - static_cast<double>(panels)) / wide;
    if (cost < best_cost) best_cost = cost, best = {c, rows_for(c)};
  }
  return best;
}

bool has_slopes(const Multiples& m) {
  return m.slope_triangles && m.log_x && m.log_y;
}

/// Sizes of the grid; all panels are equal.
struct PanelLayout {
  Grid grid;
  bool orders_as_text = false;   ///< orders stand above the axes: triangles have no room in small panels
  double left = 0, top = 0;      ///< corner of the first panel's axes
  double width = 0, height = 0;  ///< size of a panel's axes
  double gap_x = 0, gap_y = 0;   ///< gaps between axes, titles and numbers included
};

/// A panel has numbers beneath it where no panel follows below.
bool is_lowest(std::size_t panel, std::size_t panels, const Grid& grid) {
  return panel + grid.columns >= panels;
}

PanelLayout lay_out(const Canvas& canvas, const Theme& theme, const Multiples& m, const Sheet& sheet, const Box& space,
                    Scales& s) {
  PanelLayout at;
  at.grid = grid_of(m.panels.size(), m.columns, space);
  const auto columns = static_cast<double>(at.grid.columns), rows = static_cast<double>(at.grid.rows);
  const double numbers = 16 * theme.unit + 1.2 * theme.text;
  const double title_alone = 1.7 * theme.text;
  const double least = 16 * theme.text;  // least size of a panel that triangles fit
  at.orders_as_text =
      has_slopes(m) && std::min(space.width() / columns, space.height() / rows - title_alone - numbers) < least;
  const double title = title_alone + (at.orders_as_text ? 1.3 * theme.text : 0);
  const bool is_ragged = m.panels.size() % at.grid.columns != 0 && at.grid.rows > 1;
  at.gap_y = title + 0.6 * theme.text + (is_ragged ? numbers : 0);
  at.top = space.y0 + title;
  at.height = (space.y1 - numbers - at.top - (rows - 1) * at.gap_y) / rows;
  const double rough_width = (space.width() - 4 * theme.text) / columns - 1.5 * theme.text;
  s = axes_of(sheet.contents, m.log_x, m.log_y, std::clamp(static_cast<int>(rough_width / theme.text / 5), 1, 9),
              std::clamp(static_cast<int>(at.height / theme.text / 1.9), 1, 8));
  const double widest_x = widest_label(canvas, theme, s.x.ticks);
  at.left = space.x0 + widest_label(canvas, theme, s.y.ticks) + 12 * theme.unit;
  at.gap_x = std::max(1.5 * theme.text, widest_x + theme.text);
  at.width = (space.x1 - 0.5 * widest_x - at.left - (columns - 1) * at.gap_x) / columns;
  if (!(at.width > 3 * theme.text && at.height > 2 * theme.text)) {
    throw std::invalid_argument("small multiples of " + std::to_string(m.panels.size()) + " panels do not fit " +
                                std::to_string(m.width) + " x " + std::to_string(m.height) +
                                " pixels: ask for a larger figure, or for fewer panels");
  }
  return at;
}

constexpr double order_mark = 0.9, order_gap = 0.6;  ///< sizes of text

/// The digits behind the point with which the orders of every panel have room; at least one.
int digits_of_orders(const Canvas& canvas, const Theme& theme, const std::vector<Content>& contents, double width) {
  for (const Content& content : contents) {
    double end = -order_gap * theme.text;
    for (const Shown& shown : content.series)
      if (const auto order = order_of(shown))
        end += (order_mark + order_gap) * theme.text + canvas.measure_text(fixed(*order, 2), theme.text);
    if (end > width) return 1;
  }
  return 2;
}

/// Draws the observed orders of a panel in the colours of their series, each beside its mark; an order that has no room
/// is dotted.
void draw_orders(Canvas& canvas, const Theme& theme, const Content& content, Point at, double width, int digits) {
  double x = at.x;
  for (const Shown& shown : content.series) {
    const auto order = order_of(shown);
    if (!order) continue;
    const std::string text = fixed(*order, digits);
    const double mark = order_mark * theme.text, end = x + mark + canvas.measure_text(text, theme.text);
    const Colour colour = readable_text(shown.look.colour);
    if (end > at.x + width) return canvas.text({x, at.y}, "…", theme.style(colour));
    draw_mark(canvas, shown.look, {x + 0.35 * theme.text, at.y - 0.35 * theme.text}, 6 * theme.unit, theme.unit);
    canvas.text({x + mark, at.y}, text, theme.style(colour));
    x = end + order_gap * theme.text;
  }
}

void draw_panels(Canvas& canvas, const Theme& theme, const Multiples& m, Sheet& sheet, const Box& space) {
  Scales s;
  const PanelLayout at = lay_out(canvas, theme, m, sheet, space, s);
  canvas.text({space.x0, space.y0 - 0.9 * theme.text}, with_factor(m.y_label, s.y.ticks.exponent), theme.style());
  const int digits = digits_of_orders(canvas, theme, sheet.contents, at.width);
  for (std::size_t k = 0; k < m.panels.size(); ++k) {
    const std::size_t column = k % at.grid.columns, row = k / at.grid.columns;
    const double x = at.left + static_cast<double>(column) * (at.width + at.gap_x);
    const double y = at.top + static_cast<double>(row) * (at.height + at.gap_y);
    s.box = {x, y, x + at.width, y + at.height};
    const std::string title = shortened(canvas, m.panels[k].title, theme.text, at.width, true);
    if (at.orders_as_text) draw_orders(canvas, theme, sheet.contents[k], {x, y - 0.5 * theme.text}, at.width, digits);
    canvas.text({x, y - (at.orders_as_text ? 1.8 : 0.5) * theme.text}, title,
                {theme.text, kInk, Anchor::start, Baseline::alphabetic, 0, true});
    draw_scales(canvas, theme, s, is_lowest(k, m.panels.size(), at.grid), column == 0);
    draw_curves(canvas, theme, s, sheet.contents[k],
                {has_slopes(m) && !at.orders_as_text, m.pareto_front, x + at.width});
  }
  const double middle = at.left + 0.5 * (static_cast<double>(at.grid.columns) * (at.width + at.gap_x) - at.gap_x);
  canvas.text({middle, space.y1 + 1.2 * theme.text}, with_factor(m.x_label, s.x.ticks.exponent),
              theme.style(kInk, Anchor::middle));
}

void draw_multiples(Canvas& canvas, const Multiples& m, const Theme& theme, Sheet& sheet) {
  const std::string slopes = has_slopes(m) ? "slopes: observed order, least squares over all points" : "";
  const Box page = draw_page(canvas, theme, m.title, joined(joined(m.footnote, slopes), sheet.remark));
  if (m.panels.empty()) {
    canvas.text(page.centre(), "no data to show", theme.style(kQuiet, Anchor::middle));
    return;
  }
  std::vector<LegendEntry> legend;
  for (const Shown& shown : sheet.legend) legend.push_back(legend_entry(shown, theme.unit));
  const double top = page.y0 + lay_legend(canvas, theme, legend, page, &canvas) + 2.4 * theme.text;
  draw_panels(canvas, theme, m, sheet, {page.x0, top, page.x1, page.y1 - 1.6 * theme.text});
}

std::vector<std::string> titles_of(const Multiples& m) {
  std::vector<std::string> titles;
  for (const Panel& panel : m.panels) titles.push_back(panel.title);
  return titles;
}

}  // namespace

void write_figure(const Multiples& multiples, const std::filesystem::path& stem) {
  check(multiples);
  const Theme theme = theme_for(multiples.width, multiples.height);
  Sheet sheet = sheet_of(multiples, theme.unit);
  write_all(stem, multiples.width, multiples.height, multiples.title,
            table_of(sheet.contents, titles_of(multiples), multiples.x_label, multiples.y_label),
            [&](Canvas& canvas) { draw_multiples(canvas, multiples, theme, sheet); });
}

}  // namespace mpm::render
