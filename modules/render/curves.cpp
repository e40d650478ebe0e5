#include "render/curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "render/polyline.hpp"
#include "support/csv.hpp"
#include "support/numbers.hpp"

namespace mpm::render {
namespace {

constexpr Marker kMarkers[] = {Marker::circle, Marker::square,        Marker::triangle, Marker::diamond,
                               Marker::cross,  Marker::down_triangle, Marker::plus};

std::vector<double> dash_of(std::size_t index, double u) {
  switch (index % 4) {
    case 1:
      return {22 * u, 8 * u};
    case 2:
      return {9 * u, 6 * u};
    case 3:
      return {22 * u, 6 * u, 5 * u, 6 * u};
    default:
      return {};
  }
}

Look look_of(SeriesKind kind, std::size_t coloured, std::size_t black, double u) {
  const Colour colour = palette(coloured);
  // Marks are shifted at each return of the colours, so that no pair of colour and mark comes twice in 49 series.
  const Marker marker = kMarkers[(coloured + coloured / 7 * 3) % std::size(kMarkers)];
  switch (kind) {
    case SeriesKind::exact:
      return {kBlack, {kBlack, 2 * u, dash_of(black, u)}};
    case SeriesKind::published:
      return {kBlack, {kBlack, 0}, kMarkers[black % 4], true, true};
    case SeriesKind::point:
      return {colour, {colour, 0}, marker, true};
    case SeriesKind::computed:
      break;
  }
  return {colour, {colour, 3.6 * u, dash_of(coloured, u)}, marker, true};
}

/// Marks the Pareto front. Least x and least y are best; a point is dominated when another is no worse in both and
/// better in one.
std::vector<Point> mark_front(Content& content) {
  struct Candidate {
    double x, y;
    std::size_t series, point;
  };
  std::vector<Candidate> all;
  for (std::size_t s = 0; s < content.series.size(); ++s) {
    const Series& data = content.series[s].data;
    if (data.kind != SeriesKind::point) continue;
    for (std::size_t i = 0; i < data.x.size(); ++i) all.push_back({data.x[i], data.y[i], s, i});
  }
  std::sort(all.begin(), all.end(), [](auto& a, auto& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<Point> front;
  for (const Candidate& c : all) {
    const bool is_best = front.empty() || c.y < front.back().y || (c.y == front.back().y && c.x == front.back().x);
    content.series[c.series].is_faded[c.point] = !is_best;
    if (is_best) front.push_back({c.x, c.y});
  }
  return front;
}

/// What the front attains: steps, because nothing was computed between two of its points.
std::vector<Point> staircase(const std::vector<Point>& front, const Scales& s) {
  std::vector<Point> line;
  for (const Point& p : front) {
    if (!line.empty()) line.push_back({s.at(p.x, p.y).x, line.back().y});
    line.push_back(s.at(p.x, p.y));
  }
  return line;
}

/// The points that get a mark: every point of a short series; on a long one a few, staggered so that the marks of
/// coinciding lines lie side by side.
std::vector<std::size_t> marked_points(const std::vector<Point>& line, std::size_t rank, std::size_t ranks,
                                       bool only_marks) {
  std::vector<std::size_t> chosen;
  if (only_marks || line.size() <= 30) {
    for (std::size_t i = 0; i < line.size(); ++i) chosen.push_back(i);
    return chosen;
  }
  constexpr int marks = 7;
  const double first = line.front().x, span = line.back().x - first;
  for (int k = 0; k < marks; ++k) {
    const double wanted = first + span * (k + (static_cast<double>(rank) + 0.5) / static_cast<double>(ranks)) / marks;
    std::size_t best = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (std::fabs(line[i].x - wanted) < std::fabs(line[best].x - wanted)) best = i;
    }
    chosen.push_back(best);
  }
  return chosen;
}

void draw_error_bars(Canvas& canvas, const Scales& s, const Shown& shown, double u) {
  for (std::size_t i = 0; i < shown.data.error.size(); ++i) {
    const double x = shown.data.x[i], y = shown.data.y[i], e = shown.data.error[i];
    if (!std::isfinite(e) || e <= 0) continue;
    const double low = s.y.is_log ? std::max(y - e, s.y.lo) : y - e;
    const Point a = s.at(x, low), b = s.at(x, y + e);
    const Stroke ink{shown.look.colour, 2 * u};
    canvas.line(a, b, ink);
    for (const Point& end : {a, b}) canvas.line({end.x - 6 * u, end.y}, {end.x + 6 * u, end.y}, ink);
  }
}

std::vector<Point> pixels_of(const Series& data, const Scales& s) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < data.x.size(); ++i) points.push_back(s.at(data.x[i], data.y[i]));
  return points;
}

void draw_marks(Canvas& canvas, const Theme& theme, const Scales& s, const Content& content, std::size_t rank) {
  const Shown& shown = content.series[rank];
  draw_error_bars(canvas, s, shown, theme.unit);
  const auto points = pixels_of(shown.data, s);
  const bool all = shown.data.kind != SeriesKind::computed;
  for (const std::size_t i : marked_points(points, rank, content.series.size(), all))
    draw_mark(canvas, shown.look, points[i], 8 * theme.unit, theme.unit, shown.is_faded[i] ? 0.35 : 1);
}

void draw_series(Canvas& canvas, const Theme& theme, const Scales& s, const Content& content) {
  // The order of drawing: coloured lines first, then the thin exact ones over them, then marks, published ones on top.
  const auto is_line = [](const Shown& shown, SeriesKind kind) { return shown.data.kind == kind; };
  for (const SeriesKind kind : {SeriesKind::computed, SeriesKind::exact}) {
    for (const Shown& shown : content.series) {
      if (is_line(shown, kind)) canvas.polyline(thinned(pixels_of(shown.data, s)), shown.look.line);
    }
  }
  for (const SeriesKind kind : {SeriesKind::computed, SeriesKind::point, SeriesKind::published}) {
    // Crosses are drawn over filled marks: both stay to be seen where points coincide.
    for (const bool strokes : {false, true}) {
      for (std::size_t rank = 0; rank < content.series.size(); ++rank) {
        const Shown& shown = content.series[rank];
        const bool is_stroke = shown.look.marker == Marker::plus || shown.look.marker == Marker::cross;
        if (shown.data.kind == kind && is_stroke == strokes) draw_marks(canvas, theme, s, content, rank);
      }
    }
  }
  for (const Shown& shown : content.series) {  // the front is drawn once more, over pale marks of later series
    if (std::find(shown.is_faded.begin(), shown.is_faded.end(), true) == shown.is_faded.end()) continue;
    const auto points = pixels_of(shown.data, s);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!shown.is_faded[i]) draw_mark(canvas, shown.look, points[i], 8 * theme.unit, theme.unit, 1);
    }
  }
}

/// What stands in the plot already: new labels look for a place that none of it crosses.
struct Occupied {
  std::vector<std::vector<Point>> lines;
  std::vector<Box> boxes;
  std::vector<Box> labels;  ///< two labels in one place can neither be read, a label over a mark can

  double cost(const Box& box) const {
    double sum = 0;
    for (const Box& other : boxes) sum += box.overlaps(other) ? 10 : 0;
    for (const Box& other : labels) sum += box.overlaps(other) ? 60 : 0;
    for (const auto& line : lines) {
      for (std::size_t i = 0; i + 1 < line.size(); ++i) sum += crosses(line[i], line[i + 1], box) ? 3 : 0;
    }
    return sum;
  }
};

Occupied occupied_by(const Content& content, const Scales& s, double u) {
  Occupied result;
  for (const Shown& shown : content.series) {
    const auto points = pixels_of(shown.data, s);
    if (shown.look.line.width > 0) result.lines.push_back(thinned(points));
    if (shown.look.line.width > 0 && points.size() > 30) continue;
    for (const Point& p : points) result.boxes.push_back({p.x - 9 * u, p.y - 9 * u, p.x + 9 * u, p.y + 9 * u});
  }
  return result;
}

/// A free place beside the point, else the one least in the way, and what is wrong with it.
std::pair<Box, double> place_label(const Theme& theme, const Scales& s, Point at, double width, double labels_to,
                                   const Occupied& occupied) {
  const double gap = 14 * theme.unit, height = theme.text;
  const double directions[][2] = {{1, 0},   {-1, 0}, {0, -1}, {0, 1},  {1, -1},  {1, 1},
                                  {-1, -1}, {-1, 1}, {0, -2}, {1, -2}, {-1, -2}, {0, 2}};  // the last ones in crowds
  double best_cost = std::numeric_limits<double>::max();
  Box best;
  for (const auto& d : directions) {
    const double cx = at.x + d[0] * (gap + width / 2), cy = at.y + d[1] * (gap * 0.7 + height / 2);
    const Box box{cx - width / 2, cy - height / 2, cx + width / 2, cy + height / 2};
    const bool is_outside = box.x0 < s.box.x0 || box.x1 > labels_to || box.y0 < s.box.y0 || box.y1 > s.box.y1;
    const double cost = occupied.cost(box) + (is_outside ? 100 : 0) + (std::fabs(d[1]) > 1 ? 4 : 0);
    if (cost < best_cost) best_cost = cost, best = box;
  }
  return {best, best_cost};
}

void draw_point_labels(Canvas& canvas, const Theme& theme, const Scales& s, const Content& content, double labels_to,
                       Occupied& occupied) {
  struct Label {
    Point at;
    std::string text;
    bool is_faded;
  };
  std::vector<Label> labels;
  for (const Shown& shown : content.series)
    for (std::size_t i = 0; i < shown.data.point_labels.size(); ++i)
      if (!shown.data.point_labels[i].empty())
        labels.push_back({s.at(shown.data.x[i], shown.data.y[i]), shown.data.point_labels[i], shown.is_faded[i]});
  std::stable_sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.at.x < b.at.x; });
  for (const Label& label : labels) {
    const double width = canvas.measure_text(label.text, theme.text), air = 14 * theme.unit;
    const auto [box, cost] = place_label(theme, s, label.at, width, labels_to, occupied);
    occupied.labels.push_back(
        {box.x0 - air, box.y0, box.x1 + air, box.y1});  // two labels without air would read as one
    const Point corners[] = {{box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}};
    if (cost < 10) canvas.polygon(corners, kWhite);  // covers lines that no place keeps clear of, never a mark
    const Colour colour = mix(kWhite, kInk, label.is_faded ? 0.6 : 1);
    canvas.text(box.centre(), label.text, theme.style(colour, Anchor::middle, Baseline::middle));
  }
}

struct Triangle {
  Point a, b, corner;
  Box label;
};

/// A triangle whose long side is parallel to the fitted line, beside the data at `middle`.
Triangle slope_triangle(const Canvas& canvas, const Theme& theme, Point middle, double rise, bool is_below,
                        const std::string& text) {
  const double half = 50 * theme.unit, away = (is_below ? 20 : -20) * theme.unit;
  const Point a{middle.x - half, middle.y + rise * half + away}, b{middle.x + half, middle.y - rise * half + away};
  const bool corner_at_b = (rise > 0) == is_below;
  const Point corner{corner_at_b ? b.x : a.x, corner_at_b ? a.y : b.y};
  const double width = canvas.measure_text(text, theme.text), gap = 8 * theme.unit, y = (a.y + b.y) / 2;
  const double left = corner_at_b ? corner.x + gap : corner.x - gap - width;
  return {a, b, corner, {left, y - 0.55 * theme.text, left + width, y + 0.55 * theme.text}};
}

double cost_of(const Triangle& t, const Scales& s, const Occupied& occupied, double u) {
  Box body{std::min(t.a.x, t.b.x), std::min({t.a.y, t.b.y}), std::max(t.a.x, t.b.x), std::max(t.a.y, t.b.y)};
  const Box all{std::min(body.x0, t.label.x0), std::min(body.y0, t.label.y0), std::max(body.x1, t.label.x1),
                std::max(body.y1, t.label.y1)};
  if (all.x0 < s.box.x0 || all.x1 > s.box.x1 || all.y0 < s.box.y0 || all.y1 > s.box.y1) return 1000;
  double sum = 2 * occupied.cost(t.label);
  for (const Box& other : occupied.boxes) sum += body.overlaps(other) ? 10 : 0;
  for (const Box& other : occupied.labels) sum += body.overlaps(other) ? 10 : 0;
  const Point sides[][2] = {{t.a, t.b}, {t.b, t.corner}, {t.corner, t.a}};
  for (const auto& line : occupied.lines) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      for (const auto& side : sides) {
        for (double f = 0; f <= 1; f += 0.125) {
          const double x = side[0].x + f * (side[1].x - side[0].x), y = side[0].y + f * (side[1].y - side[0].y);
          sum += crosses(line[i], line[i + 1], {x - 5 * u, y - 5 * u, x + 5 * u, y + 5 * u}) ? 2 : 0;
        }
      }
    }
  }
  return sum;
}

void draw_slope(Canvas& canvas, const Theme& theme, const Scales& s, const Shown& shown, Occupied& occupied) {
  const auto order = order_of(shown);
  if (!order) return;
  auto points = pixels_of(shown.data, s);
  std::sort(points.begin(), points.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const double per_decade_x = s.box.width() / std::log10(s.x.hi / s.x.lo);
  const double per_decade_y = s.box.height() / std::log10(s.y.hi / s.y.lo);
  const double rise = *order * per_decade_y / per_decade_x;
  const std::string text = fixed(*order, 2);
  Triangle best;
  double best_cost = std::numeric_limits<double>::max();
  for (int k = 1; k < 40; ++k) {
    const double x = points.front().x + (points.back().x - points.front().x) * k / 40;
    const auto right =
        std::lower_bound(points.begin() + 1, points.end() - 1, x, [](auto& p, double v) { return p.x < v; });
    const Point p = *(right - 1), q = *right;
    const double y = q.x > p.x ? p.y + (q.y - p.y) * (x - p.x) / (q.x - p.x) : p.y;
    for (const bool is_below : {true, false}) {
      const Triangle t = slope_triangle(canvas, theme, {x, y}, rise, is_below, text);
      const double cost = cost_of(t, s, occupied, theme.unit) + std::fabs(k - 20) * 0.05;
      if (cost < best_cost) best_cost = cost, best = t;
    }
  }
  if (best_cost >= 1000) return;
  canvas.polyline(std::vector<Point>{best.a, best.corner, best.b, best.a, best.corner},
                  {shown.look.colour, 2 * theme.unit});
  canvas.text({best.label.x0, best.label.centre().y}, text,
              theme.style(readable_text(shown.look.colour), Anchor::start, Baseline::middle));
  occupied.boxes.push_back({std::min(best.a.x, best.b.x), std::min(best.a.y, best.b.y), std::max(best.a.x, best.b.x),
                            std::max(best.a.y, best.b.y)});
  occupied.boxes.push_back(best.label);
}

}  // namespace

const char* name_of(SeriesKind kind) {
  switch (kind) {
    case SeriesKind::computed:
      return "computed";
    case SeriesKind::exact:
      return "exact";
    case SeriesKind::published:
      return "published";
    case SeriesKind::point:
      return "point";
  }
  return "";
}

std::vector<Look> looks_of(std::span<const Series> series, double u) {
  std::vector<Look> looks;
  std::size_t coloured = 0, exact = 0, published = 0;
  for (const Series& s : series) {
    const bool is_exact = s.kind == SeriesKind::exact, is_published = s.kind == SeriesKind::published;
    std::size_t& counter = is_exact ? exact : is_published ? published : coloured;
    looks.push_back(look_of(s.kind, coloured, is_exact ? exact : published, u));
    ++counter;
  }
  return looks;
}

void check_series(std::span<const Series> series) {
  for (const Series& s : series) {
    const auto complain = [&](const std::string& what, std::size_t size) {
      throw std::invalid_argument("series '" + s.label + "': " + std::to_string(s.x.size()) + " values of x, but " +
                                  std::to_string(size) + " " + what);
    };
    if (s.y.size() != s.x.size()) complain("of y", s.y.size());
    if (!s.error.empty() && s.error.size() != s.x.size()) complain("error bars", s.error.size());
    if (!s.point_labels.empty() && s.point_labels.size() != s.x.size()) complain("point labels", s.point_labels.size());
    if (!s.point_names.empty() && s.point_names.size() != s.x.size()) complain("point names", s.point_names.size());
    if (!s.dominated_by.empty() && s.dominated_by.size() != s.x.size())
      complain("dominating points", s.dominated_by.size());
  }
}

Content select(std::span<const Series> series, std::span<const Look> looks, bool positive_x, bool positive_y) {
  Content content;
  for (std::size_t k = 0; k < series.size(); ++k) {
    const Series& s = series[k];
    Shown shown{{s.label, {}, {}, {}, s.kind, {}}, looks[k], {}};
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const bool is_finite = std::isfinite(s.x[i]) && std::isfinite(s.y[i]);
      const bool is_positive = (!positive_x || s.x[i] > 0) && (!positive_y || s.y[i] > 0);
      if (!is_finite) ++content.not_finite;
      if (is_finite && !is_positive) ++content.not_positive;
      if (!is_finite || !is_positive) continue;
      shown.data.x.push_back(s.x[i]);
      shown.data.y.push_back(s.y[i]);
      if (!s.error.empty()) shown.data.error.push_back(s.error[i]);
      if (!s.point_labels.empty()) shown.data.point_labels.push_back(s.point_labels[i]);
      if (!s.point_names.empty()) shown.data.point_names.push_back(s.point_names[i]);
      if (!s.dominated_by.empty()) shown.data.dominated_by.push_back(s.dominated_by[i]);
    }
    if (shown.data.x.empty()) {
      content.empty += (content.empty.empty() ? "" : ", ") + s.label;
      continue;
    }
    shown.is_faded.assign(shown.data.x.size(), false);
    content.has_long_lines |= shown.look.line.width > 0 && shown.data.x.size() > 30;
    content.series.push_back(std::move(shown));
  }
  return content;
}

std::string table_of(std::span<const Content> contents, const std::vector<std::string>& panels,
                     const std::string& x_label, const std::string& y_label) {
  const bool has_names = std::any_of(contents.begin(), contents.end(), [](const Content& content) {
    return std::any_of(content.series.begin(), content.series.end(),
                       [](const Shown& shown) { return !shown.data.point_names.empty(); });
  });
  const auto entry = [](const std::vector<std::string>& texts, std::size_t i) { return texts.empty() ? "" : texts[i]; };
  support::CsvText csv;
  std::vector<std::string> row{"series", "kind", x_label, y_label, "error", "point"};
  if (!panels.empty()) row.insert(row.begin(), "panel");
  if (has_names) row.insert(row.end(), {"name", "dominated by"});
  csv.row(row);
  for (std::size_t k = 0; k < contents.size(); ++k) {
    for (const Shown& shown : contents[k].series) {
      const Series& d = shown.data;
      for (std::size_t i = 0; i < d.x.size(); ++i) {
        row = {d.label,
               name_of(d.kind),
               support::full_precision(d.x[i]),
               support::full_precision(d.y[i]),
               d.error.empty() ? "" : support::full_precision(d.error[i]),
               entry(d.point_labels, i)};
        if (!panels.empty()) row.insert(row.begin(), panels[k]);
        if (has_names) row.insert(row.end(), {entry(d.point_names, i), entry(d.dominated_by, i)});
        csv.row(row);
      }
    }
  }
  return csv.text();
}

std::string remark_of(const Content& content) {
  const std::string counts = joined(counted(content.not_finite, "point", "not finite, left out"),
                                    counted(content.not_positive, "point", "not above zero, left out"));
  return content.empty.empty() ? counts : joined(counts, "no data to show: " + content.empty);
}

Scales axes_of(std::span<const Content> contents, bool log_x, bool log_y, int count_x, int count_y,
               double linear_within) {
  Range x, y;
  bool has_long_lines = false;
  for (const Content& content : contents) {
    has_long_lines |= content.has_long_lines;
    for (const Shown& shown : content.series) {
      for (const double value : shown.data.x) x.add(value);
      for (std::size_t i = 0; i < shown.data.y.size(); ++i) {
        const double v = shown.data.y[i], e = shown.data.error.empty() ? 0 : shown.data.error[i];
        y.add(v);
        if (!std::isfinite(e)) continue;
        y.add(v + e);
        if (!log_y || linear_within > 0 || v - e > 0) y.add(v - e);
      }
    }
  }
  const bool is_tight = has_long_lines && !log_x;
  Scales s;
  s.x = make_axis(x, log_x, is_tight ? 0 : 0.05, false, count_x);
  s.y = log_y && linear_within > 0 ? make_signed_log_axis(y, linear_within, 0.05, count_y)
                                   : make_axis(y, log_y, 0.05, true, count_y);
  return s;
}

std::optional<double> order_of(const Shown& shown) {
  const Series& data = shown.data;
  if (data.kind == SeriesKind::exact) return std::nullopt;
  const double n = static_cast<double>(data.x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    const double x = std::log(data.x[i]), y = std::log(data.y[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double spread_x = sxx - sx * sx / n;
  if (data.x.size() < 2 || !(spread_x > 1e-12)) return std::nullopt;
  return (sxy - sx * sy / n) / spread_x;
}

void draw_curves(Canvas& canvas, const Theme& theme, const Scales& s, Content& content, const CurveOptions& options) {
  Occupied occupied = occupied_by(content, s, theme.unit);
  if (options.front) {
    occupied.lines.push_back(staircase(mark_front(content), s));
    canvas.polyline(occupied.lines.back(), {kQuiet, 2 * theme.unit, {10 * theme.unit, 7 * theme.unit}});
  }
  draw_series(canvas, theme, s, content);
  if (options.slopes) {
    for (const Shown& shown : content.series) draw_slope(canvas, theme, s, shown, occupied);
  }
  draw_point_labels(canvas, theme, s, content, options.labels_to, occupied);
  if (content.series.empty()) canvas.text(s.box.centre(), "no data to show", theme.style(kQuiet, Anchor::middle));
}

void draw_mark(Canvas& canvas, const Look& look, Point at, double radius, double u, double strength) {
  const Colour colour = mix(kWhite, look.colour, strength);
  // White around a filled mark keeps it apart from lines that pass beneath.
  if (look.is_hollow) return canvas.marker(at, look.marker, radius, kWhite, {colour, 2.4 * u});
  canvas.marker(at, look.marker, radius, colour,
                {look.marker == Marker::cross || look.marker == Marker::plus ? colour : kWhite, 1.2 * u});
}

LegendEntry legend_entry(const Shown& shown, double u) {
  return {shown.data.label,
          [&shown, u](Canvas& canvas, const Box& box) {
            if (shown.look.line.width > 0)
              canvas.line({box.x0, box.centre().y}, {box.x1, box.centre().y}, shown.look.line);
            if (shown.look.has_marker) draw_mark(canvas, shown.look, box.centre(), 8 * u, u);
          },
          shown.look.line.width > 0};
}

}  // namespace mpm::render
