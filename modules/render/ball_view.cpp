#include "render/ball_view.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace mpm::render {
namespace {

constexpr int kTile = 8;  ///< samples along a side of the squares that are asked whether a ball is hidden
constexpr float kNothing = std::numeric_limits<float>::infinity();

/// Slopes of the two rays that touch a ball, in the plane of its centre and one axis of the picture.
std::array<double, 2> touching_slopes(double centre, double ahead, double radius) {
  const double r2 = radius * radius, side = radius * std::sqrt(centre * centre + ahead * ahead - r2);
  return {(centre * ahead - side) / (ahead * ahead - r2), (centre * ahead + side) / (ahead * ahead - r2)};
}

/// From the first sample at or after `from` to the one after the last at or before `to`, within [0, count].
std::array<int, 2> samples_between(double from, double to, int count) {
  return {static_cast<int>(std::clamp(std::ceil(from), 0.0, double(count))),
          static_cast<int>(std::clamp(std::floor(to) + 1, 0.0, double(count)))};
}

Window window_of(const Vec3& centre, double radius, const Camera& camera, int samples) {
  const Box& view = camera.view();
  const auto [left, right] = touching_slopes(centre[0], -centre[2], radius);
  const auto [bottom, top] = touching_slopes(centre[1], -centre[2], radius);
  const auto column = [&](double slope) {
    return (slope * camera.scale() + camera.axis().x - view.x0) * samples - 0.5;
  };
  const auto row = [&](double slope) { return (camera.axis().y - slope * camera.scale() - view.y0) * samples - 0.5; };
  const auto [x0, x1] = samples_between(column(left), column(right), static_cast<int>(view.width()) * samples);
  const auto [y0, y1] = samples_between(row(top), row(bottom), static_cast<int>(view.height()) * samples);
  return {x0, y0, x1, y1};
}

/// Numbers of the balls, nearest first by steps fine enough that few hidden balls come before what hides them.
std::vector<int> nearest_first(const SeenBalls& balls) {
  constexpr int steps = 4096;
  std::vector<int> order(balls.count());
  if (order.empty()) return order;
  const auto [least, most] = std::minmax_element(balls.ahead.begin(), balls.ahead.end());
  const float near = *least, scale = (steps - 1) / std::max(*most - near, 1e-30f);
  const auto step_of = [&](std::size_t k) { return static_cast<std::size_t>((balls.ahead[k] - near) * scale); };
  std::array<int, steps + 1> start{};
  for (std::size_t k = 0; k < order.size(); ++k) ++start[step_of(k) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  for (std::size_t k = 0; k < order.size(); ++k)
    order[static_cast<std::size_t>(start[step_of(k)]++)] = static_cast<int>(k);
  return order;
}

/// Draws balls one after another into a view.
class Drawing {
 public:
  Drawing(const SeenBalls& balls, const Rays& rays, const Window& window)
      : balls_(balls),
        rays_(rays),
        view_{window, std::vector<float>(area(window), kNothing), std::vector<int>(area(window), 0)},
        tiles_across_((window.width() + kTile - 1) / kTile) {
    const std::size_t tiles =
        static_cast<std::size_t>(tiles_across_) * static_cast<std::size_t>((window.height() + kTile - 1) / kTile);
    farthest_.assign(tiles, kNothing);
    is_stale_.assign(tiles, 0);
  }

  void draw(int ball) {
    const Window& w = balls_.window[static_cast<std::size_t>(ball)];
    if (w.is_empty() || is_hidden(ball, w)) return;
    for (int y = w.y0; y < w.y1; ++y) draw_row(ball, w, y);
    for_tiles(w, [&](std::size_t tile) {
      is_stale_[tile] = 1;
      return true;
    });
  }

  BallView taken() { return std::move(view_); }

 private:
  static std::size_t area(const Window& w) {
    return static_cast<std::size_t>(w.width()) * static_cast<std::size_t>(w.height());
  }

  /// Calls `visit` for the tiles that a window touches, until one says false; returns whether all said true.
  template <class Visit>
  bool for_tiles(const Window& w, Visit visit) {
    const Window& all = view_.window;
    for (int row = (w.y0 - all.y0) / kTile; row <= (w.y1 - 1 - all.y0) / kTile; ++row)
      for (int column = (w.x0 - all.x0) / kTile; column <= (w.x1 - 1 - all.x0) / kTile; ++column)
        if (!visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles_across_) +
                   static_cast<std::size_t>(column)))
          return false;
    return true;
  }

  bool is_hidden(int ball, const Window& w) {
    const auto k = static_cast<std::size_t>(ball);
    const float nearest = balls_.ahead[k] - balls_.radius[k];
    return for_tiles(w, [&](std::size_t tile) { return farthest_in(tile) < nearest; });
  }

  float farthest_in(std::size_t tile) {
    if (!is_stale_[tile]) return farthest_[tile];
    const Window& all = view_.window;
    const int row = static_cast<int>(tile) / tiles_across_ * kTile,
              column = static_cast<int>(tile) % tiles_across_ * kTile;
    const int columns = std::min(kTile, all.width() - column);
    float farthest = 0;
    for (int y = row; y < std::min(row + kTile, all.height()); ++y) {
      const float* ahead = &view_.ahead[view_.at(all.x0 + column, all.y0 + y)];
      for (int i = 0; i < columns; ++i) farthest = std::max(farthest, ahead[i]);
    }
    is_stale_[tile] = 0;
    return farthest_[tile] = farthest;
  }

  void draw_row(int ball, const Window& w, int y) {
    const auto k = static_cast<std::size_t>(ball);
    const float centre = balls_.ahead[k], r2 = balls_.radius[k] * balls_.radius[k];
    const float* const dx = &rays_.x[static_cast<std::size_t>(w.x0)];
    const float dy = rays_.y[static_cast<std::size_t>(y)];
    // Offsets from the centre in its plane are small beside its distance: only so are float's digits enough.
    const auto first = static_cast<float>(double(centre) * dx[0] - balls_.x[k]);
    const auto oy = static_cast<float>(double(centre) * dy - balls_.y[k]);
    const float step = centre * rays_.step, dy2 = dy * dy + 1;
    float* const ahead = &view_.ahead[view_.at(w.x0, y)];
    int* const seen = &view_.ball[view_.at(w.x0, y)];
#pragma omp simd
    for (int i = 0; i < w.width(); ++i) {
      const float ox = first + step * static_cast<float>(i);
      const float length2 = dx[i] * dx[i] + dy2, along = ox * dx[i] + oy * dy;
      const float chord2 = along * along + length2 * (r2 - ox * ox - oy * oy);
      const float point = centre - (along + std::sqrt(std::max(chord2, 0.0f))) / length2;
      const bool is_seen = chord2 >= 0 && point < ahead[i];
      ahead[i] = is_seen ? point : ahead[i];
      seen[i] = is_seen ? ball : seen[i];
    }
  }

  const SeenBalls& balls_;
  const Rays& rays_;
  BallView view_;
  int tiles_across_;
  std::vector<float> farthest_;  ///< point seen in each tile, m
  std::vector<char> is_stale_;   ///< tiles drawn into since their farthest point was found
};

}  // namespace

Rays rays_through(const Camera& camera, int samples) {
  const Box& view = camera.view();
  Rays rays{std::vector<float>(static_cast<std::size_t>(view.width()) * static_cast<std::size_t>(samples)),
            std::vector<float>(static_cast<std::size_t>(view.height()) * static_cast<std::size_t>(samples)),
            static_cast<float>(1 / (camera.scale() * samples))};
  const auto middle = [&](std::size_t i) { return (static_cast<double>(i) + 0.5) / samples; };
  for (std::size_t i = 0; i < rays.x.size(); ++i)
    rays.x[i] = static_cast<float>((view.x0 + middle(i) - camera.axis().x) / camera.scale());
  for (std::size_t j = 0; j < rays.y.size(); ++j)
    rays.y[j] = static_cast<float>((camera.axis().y - view.y0 - middle(j)) / camera.scale());
  return rays;
}

SeenBalls seen_balls(const std::vector<Ball>& balls, const Camera& camera, int samples) {
  SeenBalls seen;
  for (auto* values : {&seen.x, &seen.y, &seen.ahead, &seen.radius, &seen.red, &seen.green, &seen.blue})
    values->reserve(balls.size());
  seen.window.reserve(balls.size());
  for (const Ball& ball : balls) {
    const Vec3 centre = camera.to_eye(ball.centre);
    const double ahead = -centre[2];
    if (ahead < camera.nearest() || ahead > camera.farthest() || !(ball.radius > 0) || ball.radius >= ahead) continue;
    seen.x.push_back(static_cast<float>(centre[0]));
    seen.y.push_back(static_cast<float>(centre[1]));
    seen.ahead.push_back(static_cast<float>(ahead));
    seen.radius.push_back(static_cast<float>(ball.radius));
    seen.red.push_back(static_cast<float>(ball.colour.r));
    seen.green.push_back(static_cast<float>(ball.colour.g));
    seen.blue.push_back(static_cast<float>(ball.colour.b));
    seen.window.push_back(window_of(centre, ball.radius, camera, samples));
  }
  return seen;
}

BallView view_of(const SeenBalls& balls, const Rays& rays, const Window& window) {
  Drawing drawing(balls, rays, window);
  for (const int ball : nearest_first(balls)) drawing.draw(ball);
  return drawing.taken();
}

void light_row(const SeenBalls& balls, const BallView& view, const Rays& rays, int y, const Vec3& to_light,
               std::vector<std::uint32_t>& rgba) {
  static_assert(std::endian::native == std::endian::little, "the bytes of a colour follow one another in memory");
  const Window& w = view.window;
  const std::size_t start = view.at(w.x0, y), count = static_cast<std::size_t>(w.width());
  rgba.resize(count);
  std::uint32_t* const out = rgba.data();
  const float *const dx = &rays.x[static_cast<std::size_t>(w.x0)], dy = rays.y[static_cast<std::size_t>(y)];
  const float lx = float(to_light[0]), ly = float(to_light[1]), lz = float(to_light[2]);
  const float *const ahead = &view.ahead[start], *const bx = balls.x.data(), *const by = balls.y.data();
  const float *const bz = balls.ahead.data(), *const radius = balls.radius.data();
  const float *const red = balls.red.data(), *const green = balls.green.data(), *const blue = balls.blue.data();
  const int* const seen = &view.ball[start];
  const auto byte = [](float value) {
    const float rounded = 255 * std::max(0.0f, std::min(value, 1.0f)) + 0.5f;
    return static_cast<std::uint32_t>(static_cast<int>(rounded));
  };
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    const int k = seen[i];
    const float inverse = 1 / radius[k], z = ahead[i] < kNothing ? ahead[i] : 0.0f;
    const float nx = (dx[i] * z - bx[k]) * inverse, ny = (dy * z - by[k]) * inverse, nz = (bz[k] - z) * inverse;
    const float lambert = 0.5f * (nx * lx + ny * ly + nz * lz) + 0.5f;
    const float back = 1 / std::sqrt(dx[i] * dx[i] + dy * dy + 1);
    const float hx = lx - dx[i] * back, hy = ly - dy * back, hz = lz + back;
    const float mirrored = std::max((nx * hx + ny * hy + nz * hz) / std::sqrt(hx * hx + hy * hy + hz * hz), 0.0f);
    const float cube = mirrored * mirrored * mirrored, power6 = cube * cube, power12 = power6 * power6;
    // The added light keeps the dark end of a colour map from looking flat.
    const float factor = 0.60f + 0.42f * lambert, added = 0.09f * lambert * lambert + 0.08f * power12 * power12;
    out[i] = byte(red[k] * factor + added) | byte(green[k] * factor + added) << 8 |
             byte(blue[k] * factor + added) << 16 | 0xFF000000u;
  }
}

std::array<float, 3> normal_at(const SeenBalls& balls, const BallView& view, const Rays& rays, int x, int y) {
  const std::size_t at = view.at(x, y), k = static_cast<std::size_t>(view.ball[at]);
  const float z = view.ahead[at], inverse = 1 / balls.radius[k];
  return {(rays.x[static_cast<std::size_t>(x)] * z - balls.x[k]) * inverse,
          (rays.y[static_cast<std::size_t>(y)] * z - balls.y[k]) * inverse, (balls.ahead[k] - z) * inverse};
}

}  // namespace mpm::render
