#include "render/chart.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "render/gl_canvas.hpp"
#include "render/svg_canvas.hpp"
#include "support/files.hpp"

namespace mpm::render {
namespace {

constexpr int kSamples = 3;  ///< samples a pixel in each direction
constexpr double kLineSpacing = 1.35;

void draw_value_numbers(Canvas& canvas, const Theme& theme, const Scales& s, bool show_numbers) {
  for (std::size_t i = 0; i < s.y.ticks.major.size(); ++i) {
    const double y = s.at(s.x.lo, s.y.ticks.major[i]).y;
    canvas.line({s.box.x0, y}, {s.box.x1, y}, {kGrid, 1.5 * theme.unit});
    if (!show_numbers) continue;
    canvas.text({s.box.x0 - 12 * theme.unit, y}, s.y.ticks.labels[i], theme.style(kInk, Anchor::end, Baseline::middle));
  }
  for (const double value : s.y.ticks.minor) {
    const double y = s.at(s.x.lo, value).y;
    canvas.line({s.box.x0 - 5 * theme.unit, y}, {s.box.x0, y}, {mix(kGrid, kQuiet, 0.5), theme.unit});
  }
}

void draw_x_axis(Canvas& canvas, const Theme& theme, const Scales& s, bool show_numbers) {
  const Stroke ink{kQuiet, 1.5 * theme.unit};
  canvas.line({s.box.x0, s.box.y1}, {s.box.x1, s.box.y1}, ink);
  for (const double value : s.x.ticks.minor) {
    const double x = s.at(value, s.y.lo).x;
    canvas.line({x, s.box.y1}, {x, s.box.y1 + 5 * theme.unit}, ink);
  }
  double free_from = -1e9;
  for (std::size_t i = 0; i < s.x.ticks.major.size(); ++i) {
    const double x = s.at(s.x.ticks.major[i], s.y.lo).x;
    canvas.line({x, s.box.y1}, {x, s.box.y1 + 9 * theme.unit}, ink);
    const double half = canvas.measure_text(s.x.ticks.labels[i], theme.text) / 2;
    if (!show_numbers || x - half < free_from) continue;
    canvas.text({x, s.box.y1 + 16 * theme.unit}, s.x.ticks.labels[i], theme.style(kInk, Anchor::middle, Baseline::top));
    free_from = x + half + 0.4 * theme.text;
  }
}

}  // namespace

Theme theme_for(int width, int height) {
  const double h = height;
  // Lines of a small picture stay wide enough to be seen.
  return {double(width), h, std::max(h / 1000, 0.6), h / 43, h / 43 * 1.4, std::min(h, double(width)) * 0.04};
}

namespace {

/// The end of the word that begins at `begin`. A unit such as "(10⁻³ m)" is one word.
std::size_t end_of_word(std::string_view text, std::size_t begin) {
  constexpr std::size_t longest_unit = 20;
  const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
  const std::size_t open = text.substr(0, end).rfind('(');
  if (open == std::string_view::npos || open < begin || text.substr(open, end - open).find(')') != text.npos)
    return end;
  const std::size_t close = text.find_first_of(")\n", end);
  if (close == std::string_view::npos || text[close] == '\n' || close - open > longest_unit) return end;
  return std::min(text.find_first_of(" \n", close), text.size());
}

}  // namespace

std::vector<std::string> wrapped(const Canvas& canvas, std::string_view text, double size, double width, bool bold) {
  std::vector<std::string> lines;
  std::string line;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = end_of_word(text, i);
    const std::string word(text.substr(i, end - i));
    const std::string longer = line.empty() ? word : line + " " + word;
    if (!line.empty() && canvas.measure_text(longer, size, bold) > width) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
    if (end < text.size() && text[end] == '\n') lines.push_back(std::exchange(line, {}));
    i = end + 1;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::string shortened(const Canvas& canvas, std::string_view text, double size, double width, bool bold) {
  if (canvas.measure_text(text, size, bold) <= width) return std::string(text);
  for (std::size_t end = text.size(); end > 0;) {
    do --end;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80);  // never inside a code point
    const std::size_t last = text.substr(0, end).find_last_not_of(' ');
    const std::string result = std::string(text.substr(0, last == std::string_view::npos ? 0 : last + 1)) + "…";
    if (canvas.measure_text(result, size, bold) <= width) return result;
  }
  return "…";
}

Box draw_page(Canvas& canvas, const Theme& theme, const std::string& title, const std::string& footnote) {
  const double room = theme.width - 2 * theme.margin;
  double top = theme.margin;
  for (const auto& line : wrapped(canvas, title, theme.title, room, true)) {
    canvas.text({theme.margin, top}, line, {theme.title, kInk, Anchor::start, Baseline::top, 0, true});
    top += theme.title * kLineSpacing;
  }
  const auto foot = wrapped(canvas, footnote, theme.text, room);
  double bottom = theme.height - theme.margin * 0.7;
  for (auto line = foot.rbegin(); line != foot.rend(); ++line) {
    canvas.text({theme.margin, bottom}, *line, theme.style(kQuiet));
    bottom -= theme.text * kLineSpacing;
  }
  // One line is kept free even without a footnote, so that a remark on one frame of a film does not move the picture.
  if (foot.empty()) bottom -= theme.text * kLineSpacing;
  bottom -= 0.3 * theme.text;
  return {theme.margin, top, theme.width - theme.margin, bottom};
}

namespace {

/// Grows like the value within `linear`, and like its logarithm beyond.
double signed_log(double value, double linear) {
  return std::copysign(std::log1p(std::fabs(value) / linear), value);
}

}  // namespace

double Axis::fraction(double value) const {
  if (is_log && linear_within > 0) {
    const double first = signed_log(lo, linear_within);
    return (signed_log(value, linear_within) - first) / (signed_log(hi, linear_within) - first);
  }
  if (is_log) return std::log(value / lo) / std::log(hi / lo);
  return (value - lo) / (hi - lo);
}

void Range::add(double value) {
  if (!std::isfinite(value)) return;
  lo = std::min(lo.value_or(value), value);
  hi = std::max(hi.value_or(value), value);
}

Axis make_axis(const Range& range, bool is_log, double pad, bool zero, int count) {
  Axis axis;
  axis.is_log = is_log;
  if (!range.lo) {
    axis.lo = is_log ? 0.1 : 0;
  } else if (is_log) {
    const double span = std::max(std::log10(*range.hi / *range.lo), 0.1);
    const double centre = (std::log10(*range.hi) + std::log10(*range.lo)) / 2;
    axis.lo = std::pow(10.0, centre - span * (0.5 + pad));
    axis.hi = std::pow(10.0, centre + span * (0.5 + pad));
  } else {
    double lo = *range.lo, hi = *range.hi;
    const double size = std::max(std::fabs(lo), std::fabs(hi));
    if (zero && lo > 0 && lo < 0.4 * hi) lo = 0;
    if (zero && hi < 0 && hi > 0.4 * lo) hi = 0;
    // A constant, or one that only rounding disturbs, must not be blown up into noise.
    const double least = size > 0 ? 1e-9 * size : 1;
    if (hi - lo < least) {
      const double wanted = size > 0 ? 0.1 * size : 1;
      lo -= wanted / 2, hi += wanted / 2;
    }
    const double air = pad * (hi - lo);
    axis.lo = zero && lo == 0 ? 0 : lo - air;
    axis.hi = zero && hi == 0 ? 0 : hi + air;
  }
  axis.ticks = is_log ? log_ticks(axis.lo, axis.hi, count) : linear_ticks(axis.lo, axis.hi, count);
  return axis;
}

Axis make_signed_log_axis(const Range& range, double linear, double pad, int count) {
  Axis axis;
  axis.is_log = true, axis.linear_within = linear;
  const double low = signed_log(range.lo.value_or(-linear), linear),
               high = signed_log(range.hi.value_or(linear), linear);
  const double air = pad * std::max(high - low, 0.1);
  const auto value = [&](double place) { return std::copysign(linear * std::expm1(std::fabs(place)), place); };
  axis.lo = value(low - air), axis.hi = value(high + air);
  axis.ticks = signed_log_ticks(axis.lo, axis.hi, linear, count);
  return axis;
}

double widest_label(const Canvas& canvas, const Theme& theme, const Ticks& ticks) {
  double widest = 0;
  for (const auto& label : ticks.labels) widest = std::max(widest, canvas.measure_text(label, theme.text));
  return widest;
}

void draw_scales(Canvas& canvas, const Theme& theme, const Scales& s, bool show_x_numbers, bool show_y_numbers) {
  draw_value_numbers(canvas, theme, s, show_y_numbers);
  draw_x_axis(canvas, theme, s, show_x_numbers);
  if ((!s.y.is_log || s.y.linear_within > 0) && s.y.lo < 0 && s.y.hi > 0) {
    const double y = s.at(s.x.lo, 0).y;
    canvas.line({s.box.x0, y}, {s.box.x1, y}, {kQuiet, 2 * theme.unit});
  }
}

void draw_axes(Canvas& canvas, const Theme& theme, const Scales& s, const std::string& x_label,
               const std::string& y_label, double label_left, bool show_x_numbers) {
  draw_scales(canvas, theme, s, show_x_numbers, true);
  canvas.text({label_left, s.box.y0 - 0.9 * theme.text}, with_factor(y_label, s.y.ticks.exponent), theme.style());
  if (!show_x_numbers) return;
  const Point below{s.box.centre().x, s.box.y1 + 16 * theme.unit + 1.5 * theme.text};
  canvas.text(below, with_factor(x_label, s.x.ticks.exponent), theme.style(kInk, Anchor::middle, Baseline::top));
}

std::optional<std::vector<double>> spread(std::span<const double> centres, std::span<const double> sizes, double lo,
                                          double hi) {
  if (std::accumulate(sizes.begin(), sizes.end(), 0.0) > hi - lo) return std::nullopt;
  std::vector<std::size_t> order(centres.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return centres[a] < centres[b]; });

  // Groups of touching intervals; each stands where the mean of its members' wishes is (pooled least squares).
  struct Group {
    double start, length, wish;  // wish: sum over members of the start each would like for the group
    std::size_t count;
  };
  const auto settle = [&](Group& g) {
    g.start = std::clamp(g.wish / static_cast<double>(g.count), lo, std::max(lo, hi - g.length));
  };
  std::vector<Group> groups;
  for (const std::size_t i : order) {
    Group group{0, sizes[i], centres[i] - sizes[i] / 2, 1};
    settle(group);
    while (!groups.empty() && groups.back().start + groups.back().length > group.start) {
      const Group& before = groups.back();
      group = {0, before.length + group.length,
               before.wish + group.wish - static_cast<double>(group.count) * before.length, before.count + group.count};
      settle(group);
      groups.pop_back();
    }
    groups.push_back(group);
  }
  std::vector<double> result(centres.size());
  auto next = order.begin();
  for (const Group& group : groups) {
    double at = group.start;
    for (std::size_t k = 0; k < group.count; ++k, ++next) {
      result[*next] = at + sizes[*next] / 2;
      at += sizes[*next];
    }
  }
  return result;
}

std::optional<double> end_label_room(const Canvas& canvas, const Theme& theme, std::span<const std::string> texts,
                                     double height) {
  double widest = 0;
  for (const auto& text : texts) widest = std::max(widest, canvas.measure_text(text, theme.text));
  const bool too_wide = widest > 0.27 * theme.width;
  const bool too_many = static_cast<double>(texts.size()) * theme.text * kLineSpacing > height;
  if (too_wide || too_many) return std::nullopt;
  return widest + 3.2 * theme.text;
}

std::vector<Box> end_label_boxes(const Canvas& canvas, const Theme& theme, std::span<const EndLabel> labels,
                                 const Box& box) {
  std::vector<double> centres, sizes;
  for (const EndLabel& label : labels) {
    centres.push_back(label.end.y);
    sizes.push_back(theme.text * kLineSpacing);
  }
  const auto placed = spread(centres, sizes, box.y0 - theme.text, box.y1 + theme.text);
  if (placed) centres = *placed;
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double left = box.x1 + 3 * theme.text, half = 0.55 * theme.text;
    const double width = canvas.measure_text(labels[i].text, theme.text);
    boxes.push_back({left, centres[i] - half, left + width, centres[i] + half});
  }
  return boxes;
}

void draw_end_labels(Canvas& canvas, const Theme& theme, std::span<const EndLabel> labels, const Box& box) {
  const auto boxes = end_label_boxes(canvas, theme, labels, box);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double y = boxes[i].centre().y;
    const double turn = box.x1 + 0.35 * theme.text, mark = boxes[i].x0 - 0.65 * theme.text;
    const Colour tie = mix(kWhite, labels[i].colour, 0.6);
    const std::vector<Point> path{
        labels[i].end, {std::max(turn, labels[i].end.x), labels[i].end.y}, {mark - 0.75 * theme.text, y}};
    canvas.polyline(path, {tie, 1.5 * theme.unit});
    if (labels[i].sample) labels[i].sample(canvas, {mark, y}, 7 * theme.unit);
    canvas.text({boxes[i].x0, y}, labels[i].text,
                theme.style(readable_text(labels[i].colour), Anchor::start, Baseline::middle));
  }
}

double lay_legend(const Canvas& canvas, const Theme& theme, std::span<const LegendEntry> entries, const Box& space,
                  Canvas* canvas_to_draw) {
  const double row = 1.5 * theme.text, gap = 0.5 * theme.text;
  double x = space.x0, y = space.y0;
  for (const LegendEntry& entry : entries) {
    const double sample = (entry.is_wide ? 2.6 : 0.8) * theme.text;
    const double width = sample + gap + canvas.measure_text(entry.text, theme.text);
    if (x > space.x0 && x + width > space.x1) x = space.x0, y += row;
    const double middle = y + row / 2;
    if (canvas_to_draw) {
      entry.sample(*canvas_to_draw, {x, middle - 0.4 * theme.text, x + sample, middle + 0.4 * theme.text});
      canvas_to_draw->text({x + sample + gap, middle}, entry.text, theme.style(kInk, Anchor::start, Baseline::middle));
    }
    x += width + 1.4 * theme.text;
  }
  return entries.empty() ? 0 : y + row - space.y0;
}

void write_part(const std::filesystem::path& stem, std::string_view extension, std::string_view bytes) {
  support::write_atomically(support::with_suffix(stem, extension), bytes, support::Durability::of_program);
}

void write_all(const std::filesystem::path& stem, int width, int height, const std::string& title,
               const std::string& csv, const std::function<void(Canvas&)>& draw, bool with_svg) {
  const Image picture = rasterise(width, height, kSamples, [&](GlCanvas& canvas) { draw(canvas); });
  write_part(stem, ".png", encode_png(picture));
  if (with_svg) {
    SvgCanvas vector(width, height, title);
    draw(vector);
    write_part(stem, ".svg", vector.document());
  }
  write_part(stem, ".csv", csv);
}

void check_size(int width, int height) {
  if (std::min(width, height) >= 64 && std::max(width, height) <= 32768) return;
  throw std::invalid_argument("a figure of " + std::to_string(width) + " x " + std::to_string(height) +
                              " pixels was asked for; each side must be between 64 and 32768");
}

std::vector<double> solid_or_dashed(std::size_t k, double u) {
  if (k == 0) return {};
  return k == 1 ? std::vector<double>{14 * u, 7 * u} : std::vector<double>{4 * u, 5 * u};
}

std::string counted(std::size_t n, const std::string& noun, const std::string& what) {
  return n == 0 ? "" : std::to_string(n) + " " + noun + (n == 1 ? " " : "s ") + what;
}

std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + " · " + b;
}

}  // namespace mpm::render
