#include "render/frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "render/chart.hpp"
#include "render/field_colours.hpp"
#include "render/gl_canvas.hpp"
#include "render/scene.hpp"
#include "render/svg_canvas.hpp"
#include "support/csv.hpp"
#include "support/numbers.hpp"

namespace mpm::render {
namespace {

constexpr std::size_t kMostVectorParticles = 20000;
constexpr int kPlaneSamples = 3;  ///< samples a pixel in each direction of a 2-D picture
constexpr int kSpaceSamples = 2;  ///< samples a pixel in each direction of a 3-D picture
constexpr double kOutline = 2;    ///< width of the domain's outline, units of the theme
constexpr std::array<const char*, 3> kAxisNames{"x", "y", "z"};

void check(const ParticleFrame& f) {
  check_size(f.width, f.height);
  if (f.dimension != 2 && f.dimension != 3) {
    throw std::invalid_argument("a frame has 2 or 3 dimensions, not " + std::to_string(f.dimension));
  }
  for (int d = 0; d < f.dimension; ++d) {
    if (std::isfinite(f.lower[d]) && std::isfinite(f.upper[d]) && f.lower[d] < f.upper[d]) continue;
    throw std::invalid_argument(std::string("the domain of the frame is empty or not finite along ") + kAxisNames[d]);
  }
  const std::size_t n = f.values.size(), dim = static_cast<std::size_t>(f.dimension);
  const auto expect = [&](const char* what, std::size_t found, std::size_t wanted) {
    if (found == wanted) return;
    throw std::invalid_argument("a frame of " + std::to_string(n) + " values needs " + std::to_string(wanted) + " " +
                                what + ", not " + std::to_string(found));
  };
  expect("coordinates", f.positions.size(), n * dim);
  expect("half sizes", f.half_size.size(), n);
  if (!f.domain_axes.empty()) expect("components of domain axes", f.domain_axes.size(), n * dim * dim);
  if (f.up_axis < -1 || f.up_axis >= 3) throw std::invalid_argument("up_axis is 0, 1, 2, or -1 for the last axis");
  if (f.range &&
      !(std::isfinite(f.range->first) && f.range->first <= f.range->second && std::isfinite(f.range->second))) {
    throw std::invalid_argument("the colour range of the frame is not finite, or its ends are swapped");
  }
}

std::vector<std::size_t> finite_particles(const ParticleFrame& f) {
  const std::size_t dim = static_cast<std::size_t>(f.dimension);
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < f.values.size(); ++i) {
    bool is_finite = std::isfinite(f.values[i]) && std::isfinite(f.half_size[i]);
    for (std::size_t d = 0; d < dim; ++d) is_finite &= std::isfinite(f.positions[i * dim + d]);
    for (std::size_t k = 0; k < dim * dim && !f.domain_axes.empty(); ++k) {
      is_finite &= std::isfinite(f.domain_axes[i * dim * dim + k]);
    }
    if (is_finite) shown.push_back(i);
  }
  return shown;
}

std::string metres(double length) {
  return compact(length) + " m";
}

std::string clock_text(const ParticleFrame& f) {
  return "t = " + compact(f.time) + " s · step " + fixed(static_cast<double>(f.step), 0);
}

std::string remark(const ParticleFrame& f, const std::vector<std::size_t>& shown) {
  const std::size_t dim = static_cast<std::size_t>(f.dimension);
  const auto is_outside = [&](std::size_t i) {
    for (std::size_t d = 0; d < dim; ++d) {
      if (f.positions[i * dim + d] < f.lower[d] || f.positions[i * dim + d] > f.upper[d]) return true;
    }
    return false;
  };
  const auto outside = static_cast<std::size_t>(std::count_if(shown.begin(), shown.end(), is_outside));
  return joined(counted(f.values.size() - shown.size(), "particle", "not finite, left out"),
                counted(outside, "particle", "outside the domain"));
}

/// The map from metres of a 2-D domain to pixels, with one scale for both axes.
struct PlaneView {
  Box box;
  double x0, y0, scale;
  Point at(double x, double y) const { return {box.x0 + (x - x0) * scale, box.y1 - (y - y0) * scale}; }
};

void draw_cells(Canvas& canvas, const ParticleFrame& f, const PlaneView& view, double u) {
  if (!(f.cell_size > 0) || f.cell_size * view.scale < 6 * u) return;
  const Stroke light{kGrid, u};
  for (long i = 1; f.lower[0] + i * f.cell_size < f.upper[0]; ++i) {
    const double x = view.at(f.lower[0] + i * f.cell_size, 0).x;
    canvas.line({x, view.box.y0}, {x, view.box.y1}, light);
  }
  for (long i = 1; f.lower[1] + i * f.cell_size < f.upper[1]; ++i) {
    const double y = view.at(0, f.lower[1] + i * f.cell_size).y;
    canvas.line({view.box.x0, y}, {view.box.x1, y}, light);
  }
}

std::array<Point, 4> outline_of(const ParticleFrame& f, std::size_t i, const PlaneView& view) {
  const double x = f.positions[2 * i], y = f.positions[2 * i + 1], h = f.half_size[i];
  const bool has_axes = !f.domain_axes.empty();
  const float* a = has_axes ? f.domain_axes.data() + 4 * i : nullptr;
  const double ax = has_axes ? a[0] : h, ay = has_axes ? a[1] : 0, bx = has_axes ? a[2] : 0, by = has_axes ? a[3] : h;
  return {view.at(x - ax - bx, y - ay - by), view.at(x + ax - bx, y + ay - by), view.at(x + ax + bx, y + ay + by),
          view.at(x - ax + bx, y - ay + by)};
}

/// Whether a particle is drawn without the darker rim that tells neighbours of one colour apart: on specks it would
/// drown the colour.
bool is_speck(const std::array<Point, 4>& corners, double u) {
  const double x = corners[1].x - corners[0].x, y = corners[1].y - corners[0].y;
  return x * x + y * y < 81 * u * u;
}

void draw_particles(Canvas& canvas, const ParticleFrame& f, const std::vector<std::size_t>& shown,
                    const FieldColours& colours, const PlaneView& view, double u) {
  canvas.clip(view.box);
  std::vector<Vertex> specks;  // those without a rim that come one after another
  const auto draw_specks = [&] {
    canvas.quadrilaterals(specks);
    specks.clear();
  };
  for (const std::size_t i : shown) {
    const auto corners = outline_of(f, i, view);
    const Colour colour = colours(f.values[i]);
    if (is_speck(corners, u)) {
      for (const Point& corner : corners) specks.push_back({corner, colour});
      continue;
    }
    draw_specks();
    canvas.polygon(corners, colour);
    const std::array<Point, 5> rim{corners[0], corners[1], corners[2], corners[3], corners[0]};
    canvas.polyline(rim, {mix(colour, kBlack, 0.3), u});
  }
  draw_specks();
  canvas.unclip();
}

void draw_mark(Canvas& canvas, Point at, NodeMark::State state, double u) {
  if (state == NodeMark::State::apart) return canvas.marker(at, Marker::cross, 4 * u, kBlack, {kBlack, 1.5 * u});
  canvas.marker(at, Marker::circle, 5 * u, state == NodeMark::State::sticks ? kBlack : kWhite, {kBlack, 1.5 * u});
}

/// Draws nodes over the particles, with half a cell of their normals.
void draw_marks(Canvas& canvas, const ParticleFrame& f, const PlaneView& view, double u) {
  canvas.clip(view.box);
  for (const NodeMark& mark : f.marks) {
    const auto [x, y] = mark.place;
    const Point at = view.at(x, y);
    const Point tip = view.at(x + mark.normal[0] * f.cell_size / 2, y + mark.normal[1] * f.cell_size / 2);
    canvas.line(at, tip, {kWhite, 4 * u});
    canvas.line(at, tip, {kBlack, 2 * u});
    draw_mark(canvas, at, mark.state, u);
  }
  canvas.unclip();
}

/// Says below the picture, from x on, what the marks of nodes mean.
void draw_mark_key(Canvas& canvas, const Theme& theme, double x, double y) {
  const auto write = [&](const char* text) {
    canvas.text({x, y}, text, theme.style(kInk, Anchor::start, Baseline::middle));
    x += canvas.measure_text(text, theme.text) + theme.text;
  };
  write("nodes where bodies meet:");
  for (const auto& [state, text] : {std::pair{NodeMark::State::sticks, "stick"},
                                    {NodeMark::State::slips, "slip"},
                                    {NodeMark::State::apart, "apart"}}) {
    draw_mark(canvas, {x, y}, state, theme.unit);
    x += 0.7 * theme.text;
    write(text);
  }
}

/// Paints particles that are all specks, within the outline of the domain.
void paint_specks(const TileSamples& tile, const ParticleFrame& f, const std::vector<std::size_t>& shown,
                  const FieldColours& colours, const PlaneView& view, double outline) {
  const Box& box = view.box;
  const SpeckPainter painter(tile,
                             {box.x0 + outline / 2, box.y0 + outline / 2, box.x1 - outline / 2, box.y1 - outline / 2});
  for (const std::size_t i : shown) painter.fill(outline_of(f, i, view), colours(f.values[i]));
}

/// Draws the edges of rigid bodies.
void draw_outlines(Canvas& canvas, const ParticleFrame& f, const PlaneView& view, double u) {
  canvas.clip(view.box);
  for (std::size_t k = 0; k + 3 < f.outlines.size(); k += 4)
    canvas.line(view.at(f.outlines[k], f.outlines[k + 1]), view.at(f.outlines[k + 2], f.outlines[k + 3]),
                {kInk, kOutline * u});
  canvas.unclip();
}

/// Draws a length below the picture, and returns where its writing ends.
double draw_scale_bar(Canvas& canvas, const Theme& theme, const PlaneView& view) {
  const double length = nice_below(view.box.width() / view.scale / 4);
  const double u = theme.unit, y = view.box.y1 + 1.1 * theme.text;
  const Point a{view.box.x0, y}, b{view.box.x0 + length * view.scale, y};
  const Stroke ink{kInk, 3 * u};
  canvas.line(a, b, ink);
  for (const Point& end : {a, b}) canvas.line({end.x, y - 6 * u}, {end.x, y + 6 * u}, {kInk, 2 * u});
  canvas.text({b.x + 0.6 * theme.text, y}, metres(length), theme.style(kInk, Anchor::start, Baseline::middle));
  return b.x + 0.6 * theme.text + canvas.measure_text(metres(length), theme.text);
}

/// Draws a 2-D picture. With `leaves_specks` particles are left out where all are specks, and the view to paint them in
/// is returned.
std::optional<PlaneView> draw_plane(Canvas& canvas, const ParticleFrame& f, const Theme& theme,
                                    const std::vector<std::size_t>& shown, const FieldColours& colours,
                                    bool leaves_specks) {
  const Box page = draw_page(canvas, theme, f.title, joined(f.footnote, remark(f, shown)));
  const double gap = 2 * theme.text;
  const double top = page.y0 + 1.6 * theme.text, bottom = page.y1 - 2.2 * theme.text;
  const double key = colours.key_width(canvas, theme, bottom - top);
  const double width_m = f.upper[0] - f.lower[0], height_m = f.upper[1] - f.lower[1];
  const double scale = std::min((page.width() - gap - key) / width_m, (bottom - top) / height_m);
  const double w = width_m * scale, h = height_m * scale;
  // The picture and its key together stand in the middle of the page.
  const double left = page.x0 + (page.width() - w - gap - key) / 2, upper = top + (bottom - top - h) / 2;
  const PlaneView view{{left, upper, left + w, upper + h}, f.lower[0], f.lower[1], scale};

  if (f.map == ColourMap::diverging) canvas.rectangle(view.box, {0.94, 0.94, 0.94});  // white particles need a ground
  draw_cells(canvas, f, view, theme.unit);
  const bool are_left = leaves_specks && f.marks.empty() && std::all_of(shown.begin(), shown.end(), [&](std::size_t i) {
                          return is_speck(outline_of(f, i, view), theme.unit);
                        });
  if (!are_left) draw_particles(canvas, f, shown, colours, view, theme.unit);
  if (!f.marks.empty()) draw_marks(canvas, f, view, theme.unit);
  draw_outlines(canvas, f, view, theme.unit);
  canvas.outline(view.box, {kInk, kOutline * theme.unit});
  canvas.text({view.box.x0, view.box.y0 - 0.6 * theme.text}, clock_text(f), theme.style());
  const double end = draw_scale_bar(canvas, theme, view);
  if (!f.marks.empty()) draw_mark_key(canvas, theme, end + 2 * theme.text, view.box.y1 + 1.1 * theme.text);
  // A flat domain would squash the colour bar.
  const double key_height = std::max(h, std::min(bottom - top, 12 * theme.text));
  const double key_top = std::clamp(upper + h / 2 - key_height / 2, top, std::max(top, bottom - key_height));
  colours.draw_key(canvas, theme, {view.box.x1 + gap, key_top, page.x1, key_top + key_height});
  return are_left ? std::optional(view) : std::nullopt;
}

Image plane_picture(const ParticleFrame& f, const Theme& theme, const std::vector<std::size_t>& shown,
                    const FieldColours& colours) {
  std::optional<PlaneView> left;
  return rasterise(
      f.width, f.height, kPlaneSamples,
      [&](GlCanvas& canvas) { left = draw_plane(canvas, f, theme, shown, colours, true); },
      [&](const TileSamples& tile) {
        if (left) paint_specks(tile, f, shown, colours, *left, kOutline * theme.unit);
      });
}

/// The order of the axes on the picture: two in the ground plane, then up; a cyclic shift keeps the space right-handed.
std::array<int, 3> view_axes(const ParticleFrame& f) {
  const int up = f.up_axis < 0 ? 2 : f.up_axis;
  return {(up + 1) % 3, (up + 2) % 3, up};
}

std::vector<Ball> balls_of(const ParticleFrame& f, const std::vector<std::size_t>& shown, const FieldColours& colours) {
  const auto axes = view_axes(f);
  const double same_volume = std::cbrt(6 / std::numbers::pi);  // radius of a ball with the volume of a cube of side 2
  std::vector<Ball> balls;
  balls.reserve(shown.size());
  for (const std::size_t i : shown) {
    const float* p = f.positions.data() + 3 * i;
    balls.push_back({{p[axes[0]], p[axes[1]], p[axes[2]]}, same_volume * f.half_size[i], colours(f.values[i])});
  }
  return balls;
}

/// Names and lengths of the three edges that meet the eye first.
void draw_edge_lengths(Canvas& canvas, const Theme& theme, const ParticleFrame& f, const Camera& camera, const Vec3& lo,
                       const Vec3& hi) {
  const auto axes = view_axes(f);
  const auto name = [&](int k) { return std::string(kAxisNames[axes[k]]) + ": " + metres(hi[k] - lo[k]); };
  const double away = 0.11 * std::max(hi[0] - lo[0], hi[1] - lo[1]);  // places the names beyond the rim of the ground
  const Point front = camera.project({(lo[0] + hi[0]) / 2, lo[1] - away, lo[2]});
  const Point side = camera.project({hi[0] + away, (lo[1] + hi[1]) / 2, lo[2]});
  const Point post = camera.project({lo[0], lo[1], (lo[2] + hi[2]) / 2});
  canvas.text(front, name(0), theme.style(kInk, Anchor::end, Baseline::top));
  canvas.text(side, name(1), theme.style(kInk, Anchor::start, Baseline::top));
  canvas.text({post.x - 0.6 * theme.text, post.y}, name(2), theme.style(kInk, Anchor::end, Baseline::middle));
}

/// Draws a 3-D picture: room and writing by OpenGL, then balls over them.
Image space_picture(const ParticleFrame& f, const Theme& theme, const std::vector<std::size_t>& shown,
                    const FieldColours& colours) {
  const auto axes = view_axes(f);
  const Vec3 lo{f.lower[axes[0]], f.lower[axes[1]], f.lower[axes[2]]};
  const Vec3 hi{f.upper[axes[0]], f.upper[axes[1]], f.upper[axes[2]]};
  const std::string footnote = joined(f.footnote, remark(f, shown));
  SvgCanvas measuring(f.width, f.height, "");  // only to learn how much room the writing leaves
  const Box page = draw_page(measuring, theme, f.title, footnote);
  const double key_height = 0.8 * page.height();
  const double key_left = page.x1 - colours.key_width(measuring, theme, key_height);
  const Box space{std::floor(page.x0), std::floor(page.y0 + 1.6 * theme.text), std::floor(key_left - 1.5 * theme.text),
                  std::floor(page.y1)};
  const Box inner{space.x0 + 5.5 * theme.text, space.y0 + 0.5 * theme.text, space.x1 - 2.5 * theme.text,
                  space.y1 - 1.6 * theme.text};
  if (inner.x1 - inner.x0 < 1 || inner.y1 - inner.y0 < 1)
    throw std::invalid_argument("a 3-D frame of " + std::to_string(f.width) + " x " + std::to_string(f.height) +
                                " pixels leaves no room for the scene");
  const Camera camera(lo, hi, inner, space);
  const Scene scene(balls_of(f, shown, colours), lo, hi, camera, 2 * theme.unit, kSpaceSamples);
  const auto draw = [&](GlCanvas& canvas) {
    draw_page(canvas, theme, f.title, footnote);
    scene.draw_room(canvas);
    canvas.text({page.x0, page.y0 + 0.9 * theme.text}, clock_text(f), theme.style());
    draw_edge_lengths(canvas, theme, f, camera, lo, hi);
    const double key_top = page.y0 + (page.height() - key_height) / 2;
    colours.draw_key(canvas, theme, {key_left, key_top, page.x1, key_top + key_height});
  };
  Image picture =
      rasterise(f.width, f.height, kSpaceSamples, draw, [&](const TileSamples& tile) { scene.paint_balls(tile); });
  scene.darken(picture);
  return picture;
}

std::string table_of(const ParticleFrame& f, const std::vector<std::size_t>& shown) {
  const std::size_t dim = static_cast<std::size_t>(f.dimension);
  support::CsvText csv;
  std::vector<std::string> cells;
  for (std::size_t d = 0; d < dim; ++d) cells.push_back(std::string(kAxisNames[d]) + " (m)");
  cells.push_back("half size (m)");
  const std::size_t components = f.domain_axes.empty() ? 0 : dim * dim;
  for (std::size_t k = 0; k < components; ++k) {
    cells.push_back("semi-side " + std::to_string(k / dim + 1) + " " + kAxisNames[k % dim] + " (m)");
  }
  cells.push_back(f.unit.empty() ? f.quantity : f.quantity + " (" + f.unit + ")");
  csv.row(cells);
  std::string text = csv.text();
  constexpr std::size_t digits = 12;  // of most numbers, comma included
  text.reserve(text.size() + shown.size() * cells.size() * digits);
  const auto add = [&](auto value) {
    support::append_shortest(text, value);
    text += ',';
  };
  for (const std::size_t i : shown) {
    for (std::size_t d = 0; d < dim; ++d) add(f.positions[i * dim + d]);
    add(f.half_size[i]);
    for (std::size_t k = 0; k < components; ++k) add(f.domain_axes[i * components + k]);
    support::append_shortest(text, f.values[i]);
    text += '\n';
  }
  return text;
}

}  // namespace

void write_frame(const ParticleFrame& frame, const std::filesystem::path& stem) {
  check(frame);
  const Theme theme = theme_for(frame.width, frame.height);
  const auto shown = finite_particles(frame);
  const FieldColours colours(frame, shown);
  const std::string csv = table_of(frame, shown);
  const bool is_plane = frame.dimension == 2;
  write_part(
      stem, ".png",
      encode_png(is_plane ? plane_picture(frame, theme, shown, colours) : space_picture(frame, theme, shown, colours)));
  if (is_plane && shown.size() <= kMostVectorParticles) {
    SvgCanvas vector(frame.width, frame.height, frame.title);
    draw_plane(vector, frame, theme, shown, colours, false);
    write_part(stem, ".svg", vector.document());
  }
  write_part(stem, ".csv", csv);
}

}  // namespace mpm::render
