#include "render/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace mpm::render {
namespace {

constexpr Vec3 kToLight{-0.35, -0.40, 0.85};  ///< normalised where it is used
constexpr Colour kGround{0.93, 0.93, 0.93};
constexpr Colour kEdge{0.45, 0.45, 0.45};
constexpr double kGroundOverhang = 0.05;  ///< fraction of the longer side of the domain's floor
constexpr float kLongestReach = 0.25f;    ///< of occlusion, as a fraction of the picture's width
constexpr float kNowhere = std::numeric_limits<float>::infinity();

double median_radius(const std::vector<Ball>& balls, double fallback) {
  std::vector<double> radii;
  for (const Ball& b : balls) radii.push_back(b.radius);
  if (radii.empty()) return fallback;
  std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
  return radii[radii.size() / 2];
}

std::array<double, 2> occlusion_radii(const std::vector<Ball>& balls, const Vec3& size) {
  const double longest = std::max({size[0], size[1], size[2]});
  const double ball = median_radius(balls, 0.01 * longest);
  return {2.5 * ball, std::max(0.08 * longest, 5 * ball)};
}

GroundShadow shadow_of(const std::vector<Ball>& balls, const Vec3& lo, const Vec3& hi) {
  const double overhang = kGroundOverhang * std::max(hi[0] - lo[0], hi[1] - lo[1]);
  return cast_shadow(balls, unit(kToLight), lo[2], lo[0] - overhang, lo[1] - overhang, hi[0] + overhang,
                     hi[1] + overhang);
}

Window around_all(const std::vector<Window>& windows) {
  Window all{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), 0, 0};
  for (const Window& w : windows)
    if (!w.is_empty())
      all = {std::min(all.x0, w.x0), std::min(all.y0, w.y0), std::max(all.x1, w.x1), std::max(all.y1, w.y1)};
  return all.is_empty() ? Window{} : all;
}

/// Calls `visit` with both ends of each edge of a box.
template <class Visit>
void for_each_edge(const Vec3& lo, const Vec3& hi, Visit visit) {
  const auto corners = corners_of(lo, hi);
  for (std::size_t corner = 0; corner < corners.size(); ++corner)
    for (const std::size_t axis : {1, 2, 4})
      if (!(corner & axis)) visit(corners[corner], corners[corner | axis]);
}

}  // namespace

Scene::Scene(const std::vector<Ball>& balls, const Vec3& lower, const Vec3& upper, const Camera& camera,
             double line_width, int samples)
    : camera_(camera),
      lower_(lower),
      upper_(upper),
      line_width_(line_width),
      samples_(samples),
      occlusion_radii_(occlusion_radii(balls, minus(upper, lower))),
      ground_(shadow_of(balls, lower, upper)),
      balls_(seen_balls(balls, camera, samples)),
      rays_(rays_through(camera, samples)),
      view_(view_of(balls_, rays_, around_all(balls_.window))) {}

void Scene::draw_room(GlCanvas& canvas) const {
  const GroundShadow& g = ground_;
  const std::array<Vec3, 4> corners{
      {{g.x0, g.y0, lower_[2]}, {g.x1, g.y0, lower_[2]}, {g.x1, g.y1, lower_[2]}, {g.x0, g.y1, lower_[2]}}};
  std::array<GlCanvas::DistantPoint, 4> seen;
  for (std::size_t k = 0; k < 4; ++k) seen[k] = {camera_.project(corners[k]), camera_.ahead_of(corners[k])};
  canvas.clip(camera_.view());
  canvas.lit_quadrilateral(seen, kGround, g.size, g.light);
  for_each_edge(lower_, upper_, [&](const Vec3& from, const Vec3& to) {
    canvas.line(camera_.project(from), camera_.project(to), {kEdge, line_width_});
  });
  canvas.unclip();
}

float Scene::ground_ahead(float to_right, float upwards) const {
  const Vec3 along = camera_.direction(to_right, upwards), eye = camera_.eye();
  const double ahead = (lower_[2] - eye[2]) / along[2];
  if (!(ahead > 0)) return kNowhere;
  const double x = eye[0] + ahead * along[0], y = eye[1] + ahead * along[1];
  const bool is_met = x >= ground_.x0 && x <= ground_.x1 && y >= ground_.y0 && y <= ground_.y1;
  return is_met ? static_cast<float>(ahead) : kNowhere;
}

Scene::Part Scene::part_in(const TileSamples& tile) const {
  const int left = static_cast<int>(camera_.view().x0 - tile.box.x0) * samples_;
  const int top = static_cast<int>(camera_.view().y0 - tile.box.y0) * samples_;
  const Window& w = view_.window;
  return {{std::max(w.x0, -left), std::max(w.y0, -top), std::min(w.x1, tile.columns - left),
           std::min(w.y1, tile.rows - top)},
          left,
          top};
}

void Scene::paint_balls(const TileSamples& tile) const {
  const Vec3 to_light = minus(camera_.to_eye(unit(kToLight)), camera_.to_eye({0, 0, 0}));
  const Part part = part_in(tile);
  if (part.window.is_empty()) return;
  std::vector<std::uint32_t> lit;
  for (int y = part.window.y0; y < part.window.y1; ++y) {
    light_row(balls_, view_, rays_, y, to_light, lit);
    const float upwards = rays_.y[static_cast<std::size_t>(y)];
    // A row of the picture is level, so that all its rays meet the plane of the ground equally far ahead.
    const double plane = (lower_[2] - camera_.eye()[2]) / camera_.direction(0, upwards)[2];
    for (int x = part.window.x0; x < part.window.x1; ++x) {
      const float ahead = view_.ahead[view_.at(x, y)];
      if (ahead == kNowhere) continue;
      if (plane > 0 && ahead > plane && ground_ahead(rays_.x[static_cast<std::size_t>(x)], upwards) < ahead) continue;
      std::memcpy(tile.at(x + part.left, y + part.top), &lit[static_cast<std::size_t>(x - view_.window.x0)], 4);
    }
  }
  for_each_edge(lower_, upper_, [&](const Vec3& from, const Vec3& to) { paint_edge(from, to, part, tile); });
}

/// Paints an edge of the domain where it passes in front of balls.
void Scene::paint_edge(const Vec3& from, const Vec3& to, const Part& part, const TileSamples& tile) const {
  const auto sample_of = [&](const Vec3& point) -> std::array<double, 2> {
    const Point p = camera_.project(point);
    return {(p.x - camera_.view().x0) * samples_ - 0.5, (p.y - camera_.view().y0) * samples_ - 0.5};
  };
  const auto a = sample_of(from), b = sample_of(to);
  const std::size_t u = std::abs(b[0] - a[0]) > std::abs(b[1] - a[1]) ? 0 : 1, v = 1 - u;  // u: the longer direction
  if (a[u] == b[u]) return;
  const double slope = (b[v] - a[v]) / (b[u] - a[u]), half = line_width_ * samples_ / 2 * std::hypot(1, slope);
  const double near_a = 1 / camera_.ahead_of(from), near_b = 1 / camera_.ahead_of(to);
  const std::array<int, 2> first{part.window.x0, part.window.y0}, end{part.window.x1, part.window.y1};
  const int last = std::min(end[u] - 1, static_cast<int>(std::floor(std::max(a[u], b[u]))));
  for (int i = std::max(first[u], static_cast<int>(std::ceil(std::min(a[u], b[u])))); i <= last; ++i) {
    const double middle = a[v] + slope * (i - a[u]);
    const double ahead = 1 / (near_a + (near_b - near_a) * (i - a[u]) / (b[u] - a[u]));
    const int top = std::min(end[v] - 1, static_cast<int>(std::floor(middle + half)));
    for (int j = std::max(first[v], static_cast<int>(std::ceil(middle - half))); j <= top; ++j) {
      const int x = u == 0 ? i : j, y = u == 0 ? j : i;
      const float ball = view_.ahead[view_.at(x, y)];
      if (ball != kNowhere && ahead < ball)
        std::fill_n(tile.at(x + part.left, y + part.top), 3, static_cast<std::uint8_t>(std::lround(255 * kEdge.r)));
    }
  }
}

/// Pixels of the view that balls may darken: theirs, and those within `radius` of them.
Window Scene::darkened(double radius) const {
  const Window& w = view_.window;
  if (w.is_empty()) return {};
  const Box& view = camera_.view();
  const int reach =
      static_cast<int>(std::min(std::ceil(radius * camera_.scale() / camera_.nearest()), kLongestReach * view.width()));
  const int right = static_cast<int>(view.width()), bottom = static_cast<int>(view.height());
  return {std::max(0, w.x0 / samples_ - reach), std::max(0, w.y0 / samples_ - reach),
          std::min(right, w.x1 / samples_ + reach + 1), std::min(bottom, w.y1 / samples_ + reach + 1)};
}

/// Takes the first sample of each pixel, so that a pixel never mixes two surfaces. Edges are left out: a line casts no
/// occlusion.
GeometryBuffer Scene::geometry_in(const Window& pixels) const {
  GeometryBuffer g(pixels.width(), pixels.height());
  if (pixels.is_empty()) return g;
  g.longest_reach = kLongestReach * static_cast<float>(camera_.view().width());
  g.pixel = static_cast<float>(1 / camera_.scale());
  const auto samples = static_cast<std::size_t>(samples_);
  g.left = rays_.x[static_cast<std::size_t>(pixels.x0) * samples];
  g.top = rays_.y[static_cast<std::size_t>(pixels.y0) * samples];
  const Vec3 up = minus(camera_.to_eye({0, 0, 1}), camera_.to_eye({0, 0, 0}));
  std::size_t at = 0;
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x, ++at) {
      const int column = (pixels.x0 + x) * samples_, row = (pixels.y0 + y) * samples_;
      const float ground = ground_ahead(g.right_of(x), g.up_of(y));
      const float ball = view_.window.contains(column, row) ? view_.ahead[view_.at(column, row)] : kNowhere;
      if (ball < ground)
        g.set(at, ball, normal_at(balls_, view_, rays_, column, row));
      else if (ground < kNowhere)
        g.set(at, ground, {static_cast<float>(up[0]), static_cast<float>(up[1]), static_cast<float>(up[2])});
    }
  return g;
}

void Scene::darken(Image& picture) const {
  const Window pixels = darkened(occlusion_radii_[1]);
  const std::vector<float> open = open_sky(geometry_in(pixels), occlusion_radii_);
  const float* light = open.data();
  const int left = static_cast<int>(camera_.view().x0), top = static_cast<int>(camera_.view().y0);
  for (int y = pixels.y0; y < pixels.y1; ++y)
    for (int x = pixels.x0; x < pixels.x1; ++x, ++light) {
      std::uint8_t* const rgb = picture.at(left + x, top + y);
      for (int c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>(std::lround(static_cast<float>(rgb[c]) * *light));
    }
}

}  // namespace mpm::render
