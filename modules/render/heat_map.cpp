// The heat map: numbers of pairs of categories as colours, written out in their cells.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "render/chart.hpp"
#include "render/plot.hpp"
#include "render/svg_canvas.hpp"
#include "support/csv.hpp"
#include "support/numbers.hpp"

namespace mpm::render {
namespace {

constexpr Colour kNoColour{0.92, 0.92, 0.92};
constexpr double kLine = 1.2;  ///< spacing of lines in a cell, in em

/// The least size of text that a picture may have: cells are narrow.
double cell_text(const Theme& theme) {
  return theme.height / 45;
}

void check(const HeatMap& map) {
  check_size(map.width, map.height);
  const std::size_t cells = map.x_names.size() * map.y_names.size();
  const auto complain = [&](std::size_t size, const std::string& what) {
    throw std::invalid_argument("a heat map of " + std::to_string(map.x_names.size()) + " x " +
                                std::to_string(map.y_names.size()) + " cells has " + std::to_string(size) + " " + what);
  };
  if (map.values.size() != cells) complain(map.values.size(), "values");
  if (!map.notes.empty() && map.notes.size() != cells) complain(map.notes.size(), "notes");
  if (map.digits < 1 || map.digits > 17) throw std::invalid_argument("a heat map shows 1 to 17 digits");
}

bool has_colour(const HeatMap& map, double value) {
  return std::isfinite(value) && (!map.log_scale || value > 0);
}

/// The power of ten, a multiple of three, that all numbers are divided by so that few need one of their own.
int common_exponent(const HeatMap& map) {
  Range sizes;
  for (const double value : map.values) {
    if (has_colour(map, value) && value != 0) sizes.add(std::fabs(value));
  }
  if (!sizes.lo) return 0;
  const double least = std::floor(std::log10(*sizes.lo)), largest = std::floor(std::log10(*sizes.hi));
  // On a linear scale the largest number is the one to read; on a logarithmic one all, the least as 0.01 or more.
  const double wanted = map.log_scale ? least + 2 : largest;
  const bool is_plain = (map.log_scale ? least : largest) >= -2 && largest < 4;
  return is_plain ? 0 : 3 * static_cast<int>(std::floor(wanted / 3));
}

Axis colours_of(const HeatMap& map, double factor, int count) {
  Range range;
  for (const double value : map.values) {
    if (has_colour(map, value)) range.add(value / factor);
  }
  return make_axis(range, map.log_scale, 0, false, count);
}

/// Places and sizes of everything on the page.
struct Layout {
  Box cells;
  Axis colours;                                         ///< axis of the values over `factor`
  double factor = 1;                                    ///< taken out of all numbers
  std::vector<std::vector<std::string>> rows, columns;  ///< wrapped names
  double column_width = 0, row_height = 0;
  bool is_upright = false;  ///< names of columns are turned by a right angle
  std::vector<std::string> value_label;
};

Colour colour_of(const HeatMap& map, const Layout& at, double value) {
  return has_colour(map, value) ? viridis(at.colours.fraction(value / at.factor)) : kNoColour;
}

double widest(const Canvas& canvas, double size, const std::vector<std::string>& lines) {
  double width = 0;
  for (const auto& line : lines) width = std::max(width, canvas.measure_text(line, size));
  return width;
}

std::vector<std::string> fitted(const Canvas& canvas, const Theme& theme, const std::string& text, double width,
                                std::size_t most_lines) {
  auto lines = wrapped(canvas, text, theme.text, width);
  for (std::size_t k = most_lines; k < lines.size(); ++k) lines[most_lines - 1] += " " + lines[k];
  lines.resize(std::min(lines.size(), most_lines));
  for (auto& line : lines) line = shortened(canvas, line, theme.text, width);
  return lines;
}

/// Lays column names level where every word of every name fits its column in at most three lines; else upright.
double lay_column_names(const Canvas& canvas, const Theme& theme, const HeatMap& map, double page_height, Layout& at) {
  const double width = at.column_width - 0.5 * theme.text;
  std::size_t lines = 1;
  for (const auto& name : map.x_names) {
    const auto broken = wrapped(canvas, name, theme.text, width);
    lines = std::max(lines, broken.size());
    at.is_upright |= broken.size() > 3 || widest(canvas, theme.text, broken) > width;
  }
  double length = 0;
  const double room = 0.3 * page_height;
  const auto fitting = static_cast<std::size_t>(std::max(1.0, at.column_width / (kLine * theme.text)));
  for (const auto& name : map.x_names) {
    at.columns.push_back(at.is_upright ? fitted(canvas, theme, name, room, std::min<std::size_t>(fitting, 2))
                                       : wrapped(canvas, name, theme.text, width));
    length = std::max(length, widest(canvas, theme.text, at.columns.back()));
  }
  return at.is_upright ? length : static_cast<double>(lines) * kLine * theme.text;
}

Layout lay_out(const Canvas& canvas, const Theme& theme, const HeatMap& map, const Box& page) {
  Layout at;
  const int exponent = common_exponent(map);
  at.factor = std::pow(10.0, exponent);
  at.colours = colours_of(map, at.factor, std::clamp(static_cast<int>(page.height() / theme.text / 5), 2, 8));
  at.value_label = wrapped(canvas, with_factor(map.value_label, exponent + at.colours.ticks.exponent), theme.text,
                           0.4 * page.width());
  const double key = 2.2 * theme.text + widest_label(canvas, theme, at.colours.ticks) + 12 * theme.unit;
  double names = 0;
  for (const auto& name : map.y_names) {
    at.rows.push_back(fitted(canvas, theme, name, 0.24 * page.width(), 2));
    names = std::max(names, widest(canvas, theme.text, at.rows.back()));
  }
  const double top = page.y0 + (static_cast<double>(at.value_label.size()) * 1.35 + 0.9) * theme.text;
  at.cells = {page.x0 + names + 0.6 * theme.text, top, page.x1 - key - 0.8 * theme.text, page.y1};
  at.column_width = at.cells.width() / std::max<double>(1, static_cast<double>(map.x_names.size()));
  const double below = lay_column_names(canvas, theme, map, page.height(), at);
  at.cells.y1 -= below + 2.4 * theme.text;
  at.row_height = at.cells.height() / std::max<double>(1, static_cast<double>(map.y_names.size()));
  return at;
}

/// A number with as many digits as fit the column, two at least; a power of ten may take a line of its own.
std::vector<std::string> number_in(const Canvas& canvas, double size, double value, int digits, double width) {
  std::vector<std::string> lines;
  for (int n = digits; n >= std::min(digits, 2); --n) {
    const std::string number = compact(value, n);
    const std::size_t times = number.find("×");
    lines = {number};
    if (canvas.measure_text(number, size) <= width) return lines;
    if (times == std::string::npos) continue;
    lines = {number.substr(0, times), number.substr(times)};
    if (widest(canvas, size, lines) <= width) return lines;
  }
  return lines;
}

/// Lines that fit their cell. A number that does not fit is left out whole: a part of one would mislead.
struct Writing {
  std::vector<std::string> lines;
  bool is_cut = false;
};

Writing writing_of(const Canvas& canvas, const Theme& theme, const HeatMap& map, std::size_t cell, const Layout& at) {
  const double size = cell_text(theme), width = at.column_width - 4 * theme.unit, value = map.values[cell];
  const auto most = static_cast<std::size_t>(std::max(0.0, at.row_height / (kLine * size)));
  const std::string note = map.notes.empty() ? "" : map.notes[cell];
  const auto fits = [&](const std::vector<std::string>& lines) {
    return lines.size() <= most && widest(canvas, size, lines) <= width;
  };
  std::vector<std::string> number;
  if (!std::isnan(value))
    number = number_in(canvas, size, value / at.factor / std::pow(10.0, at.colours.ticks.exponent), map.digits, width);
  std::vector<std::string> lines = number;
  for (auto& line : wrapped(canvas, std::isnan(value) && note.empty() ? "not run" : note, size, width))
    lines.push_back(std::move(line));
  if (fits(lines)) return {lines};
  const std::vector<std::string> beside{number.size() == 1 ? number.front() + " " + note : ""};
  if (number.size() == 1 && fits(beside)) return {beside};
  if (!number.empty()) return {fits(number) ? number : std::vector<std::string>{}, true};
  if (lines.size() > most) {
    lines.resize(most);
    if (most > 0) lines.back() += "…";
  }
  for (auto& line : lines) line = shortened(canvas, line, size, width);
  return {lines, true};
}

void draw_lines(Canvas& canvas, double size, const std::vector<std::string>& lines, Point centre, const Colour& colour,
                Anchor anchor, bool is_upright = false) {
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double off = (static_cast<double>(k) - 0.5 * static_cast<double>(lines.size() - 1)) * kLine * size;
    const TextStyle style{size, colour, anchor, Baseline::middle, is_upright ? 90.0 : 0.0};
    canvas.text(is_upright ? Point{centre.x + off, centre.y} : Point{centre.x, centre.y + off}, lines[k], style);
  }
}

void draw_cells(Canvas& canvas, const Theme& theme, const HeatMap& map, const Layout& at) {
  const std::size_t columns = map.x_names.size();
  const double gap = std::min(1.5 * theme.unit, 0.05 * std::min(at.column_width, at.row_height));
  for (std::size_t cell = 0; cell < map.values.size(); ++cell) {
    const std::size_t column = cell % columns, row = cell / columns;
    const double x = at.cells.x0 + static_cast<double>(column) * at.column_width;
    const double y = at.cells.y0 + static_cast<double>(row) * at.row_height;
    const Box box{x + gap, y + gap, x + at.column_width - gap, y + at.row_height - gap};
    const Colour ground = colour_of(map, at, map.values[cell]);
    canvas.rectangle(box, ground);
    const Colour ink = std::isnan(map.values[cell]) ? kQuiet : text_upon(ground);
    draw_lines(canvas, cell_text(theme), writing_of(canvas, theme, map, cell, at).lines, box.centre(), ink,
               Anchor::middle);
  }
}

void draw_names(Canvas& canvas, const Theme& theme, const HeatMap& map, const Layout& at, const Box& page) {
  for (std::size_t j = 0; j < at.rows.size(); ++j) {
    const double y = at.cells.y0 + (static_cast<double>(j) + 0.5) * at.row_height;
    draw_lines(canvas, theme.text, at.rows[j], {at.cells.x0 - 0.6 * theme.text, y}, kInk, Anchor::end);
  }
  const double below = at.cells.y1 + 0.5 * theme.text;
  for (std::size_t i = 0; i < at.columns.size(); ++i) {
    const double x = at.cells.x0 + (static_cast<double>(i) + 0.5) * at.column_width;
    const double lines = static_cast<double>(at.columns[i].size());
    if (at.is_upright)
      draw_lines(canvas, theme.text, at.columns[i], {x, below}, kInk, Anchor::end, true);
    else
      draw_lines(canvas, theme.text, at.columns[i], {x, below + 0.5 * lines * kLine * theme.text}, kInk,
                 Anchor::middle);
  }
  canvas.text({at.cells.centre().x, page.y1}, map.x_label, theme.style(kInk, Anchor::middle));
  canvas.text({page.x0, at.cells.y0 - 0.9 * theme.text}, map.y_label, theme.style());
}

void draw_key(Canvas& canvas, const Theme& theme, const Layout& at, const Box& page) {
  const double left = at.cells.x1 + 1.2 * theme.text;
  const Box bar{left, at.cells.y0, left + 1.2 * theme.text, at.cells.y1};
  constexpr int bands = 128;
  for (int k = 0; k < bands; ++k) {
    const double y1 = bar.y1 - bar.height() * k / bands, y0 = bar.y1 - bar.height() * (k + 1) / bands;
    // Each band reaches beneath the next, so that no seam shows.
    canvas.rectangle({bar.x0, std::max(bar.y0, y0 - 0.5), bar.x1, y1}, viridis((k + 0.5) / bands));
  }
  for (std::size_t k = 0; k < at.colours.ticks.major.size(); ++k) {
    const double y = bar.y1 - bar.height() * at.colours.fraction(at.colours.ticks.major[k]);
    canvas.line({bar.x1, y}, {bar.x1 + 6 * theme.unit, y}, {kQuiet, 1.5 * theme.unit});
    canvas.text({bar.x1 + 12 * theme.unit, y}, at.colours.ticks.labels[k],
                theme.style(kInk, Anchor::start, Baseline::middle));
  }
  double y = at.cells.y0 - 0.9 * theme.text;
  for (auto line = at.value_label.rbegin(); line != at.value_label.rend(); ++line, y -= 1.35 * theme.text)
    canvas.text({page.x1, y}, *line, theme.style(kInk, Anchor::end));
}

void draw_map(Canvas& canvas, const HeatMap& map, const Theme& theme) {
  std::size_t bare = 0, cut = 0;
  for (const double value : map.values) bare += !std::isnan(value) && !has_colour(map, value);
  const std::string why = map.log_scale ? "not above zero or not finite, without colour" : "not finite, without colour";
  const auto footnote = [&] {
    return joined(map.footnote,
                  joined(counted(bare, "cell", why), counted(cut, "cell", "without room for the whole text")));
  };
  // A remark takes a line of the page, so that cells are counted twice: with the room that is there without one, and with
  // the room that one leaves.
  for (int look = 0; look < 2 && !map.values.empty(); ++look) {
    SvgCanvas measuring(map.width, map.height, "");
    const Layout at = lay_out(measuring, theme, map, draw_page(measuring, theme, map.title, footnote()));
    cut = 0;
    for (std::size_t cell = 0; cell < map.values.size(); ++cell)
      cut += writing_of(measuring, theme, map, cell, at).is_cut;
  }
  const Box page = draw_page(canvas, theme, map.title, footnote());
  if (map.values.empty()) {
    canvas.text(page.centre(), "no data to show", theme.style(kQuiet, Anchor::middle));
    return;
  }
  const Layout at = lay_out(canvas, theme, map, page);
  draw_cells(canvas, theme, map, at);
  draw_names(canvas, theme, map, at, page);
  draw_key(canvas, theme, at, page);
}

std::string table_of(const HeatMap& map) {
  support::CsvText csv;
  csv.row({map.y_label, map.x_label, map.value_label, "note"});
  for (std::size_t cell = 0; cell < map.values.size(); ++cell) {
    const double value = map.values[cell];
    csv.row({map.y_names[cell / map.x_names.size()], map.x_names[cell % map.x_names.size()],
             std::isnan(value) ? "" : support::full_precision(value),
             !map.notes.empty() && !map.notes[cell].empty() ? map.notes[cell]
             : std::isnan(value)                            ? "not run"
                                                            : ""});
  }
  return csv.text();
}

}  // namespace

void write_figure(const HeatMap& map, const std::filesystem::path& stem) {
  check(map);
  const Theme theme = theme_for(map.width, map.height);
  write_all(stem, map.width, map.height, map.title, table_of(map),
            [&](Canvas& canvas) { draw_map(canvas, map, theme); });
}

}  // namespace mpm::render
