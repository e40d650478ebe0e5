// Particles in the samples of a picture: which of them is seen where, and what hides them.
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "render/ball_view.hpp"
#include "render/camera.hpp"
#include "render/gl_canvas.hpp"
#include "render/scene.hpp"
#include "render/tile_samples.hpp"
#include "support/catch.hpp"

using namespace mpm::render;

namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

Camera camera_on_unit_cube(double side) {
  return {{0, 0, 0}, {1, 1, 1}, {10, 10, side - 10, side - 10}, {0, 0, side, side}};
}

/// Metres ahead at which a ray meets a ball, from the textbook's quadratic in double precision.
double ahead_of_ball(const Ball& ball, const Camera& camera, double dx, double dy) {
  const Vec3 c = camera.to_eye(ball.centre), d{dx, dy, -1};
  const double half_b = dot(c, d), length2 = dot(d, d);
  const double quarter = half_b * half_b - length2 * (dot(c, c) - ball.radius * ball.radius);
  return quarter < 0 ? kNothing : (half_b - std::sqrt(quarter)) / length2;
}

std::vector<Ball> heap_of_balls() {
  std::mt19937 numbers(7);
  std::uniform_real_distribution<double> place(0.2, 0.8), size(0.004, 0.03);
  std::vector<Ball> balls{{{0.5, 0.5, 0.5}, 0.2, {1, 0, 0}}};  // hides many of the others
  for (int k = 0; k < 2000; ++k)
    balls.push_back({{place(numbers), place(numbers), place(numbers)}, size(numbers), {0, 0, 1}});
  return balls;
}

Image scene_of(const std::vector<Ball>& balls, int side) {
  const Scene scene(balls, {0, 0, 0}, {1, 1, 1}, camera_on_unit_cube(side), 3, 2);
  return rasterise(
      side, side, 2, [&](GlCanvas& canvas) { scene.draw_room(canvas); },
      [&](const TileSamples& tile) { scene.paint_balls(tile); });
}

bool is_red(const std::uint8_t* p) {
  return p[0] > 3 * p[1] / 2 + 30;
}

std::size_t red_pixels(const Image& image) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) count += is_red(&image.rgb[i]);
  return count;
}

/// A tile of 40 x 30 pixels that begins at (8, 4), all black.
struct Tile {
  static constexpr int samples = 3, columns = 40 * samples, rows = 30 * samples;
  std::vector<std::uint8_t> rgba = std::vector<std::uint8_t>(std::size_t{columns} * rows * 4, 0);
  TileSamples view{{8, 4, 48, 34}, samples, columns, rows, rgba};
  std::size_t count(const std::array<std::uint8_t, 3>& colour) const {
    std::size_t found = 0;
    for (std::size_t i = 0; i < rgba.size(); i += 4)
      found += rgba[i] == colour[0] && rgba[i + 1] == colour[1] && rgba[i + 2] == colour[2];
    return found;
  }
};

}  // namespace

TEST_CASE("each sample sees the nearest of the balls on its ray", "[figures]") {
  const Camera camera = camera_on_unit_cube(160);
  const std::vector<Ball> balls = heap_of_balls();
  const Rays rays = rays_through(camera, 2);
  const SeenBalls seen = seen_balls(balls, camera, 2);
  const BallView view = view_of(seen, rays, {0, 0, 320, 320});
  std::size_t wrong = 0, covered = 0;
  for (int y = 0; y < 320; y += 3)
    for (int x = 0; x < 320; x += 3) {
      double nearest = kNothing;
      for (const Ball& ball : balls)
        nearest =
            mpm::test::smaller(nearest, ahead_of_ball(ball, camera, rays.x[std::size_t(x)], rays.y[std::size_t(y)]));
      const float found = view.ahead[view.at(x, y)];
      covered += nearest < kNothing;
      // A ray that only touches a ball may miss it by rounding.
      wrong += (found == kNothing) != (nearest == kNothing) || (found < kNothing && std::abs(found - nearest) > 2e-4);
    }
  CHECK(covered > 2000);
  CHECK(wrong <= covered / 500);
}

TEST_CASE("the ground hides what lies beneath it, and edges are seen before balls", "[figures]") {
  const Colour red{1, 0.1, 0.1};
  const int side = 400;
  const std::size_t whole = red_pixels(scene_of({{{0.5, 0.5, 0.5}, 0.2, red}}, side));
  CHECK(whole > 4000);
  CHECK(red_pixels(scene_of({{{0.5, 0.5, -0.1}, 0.05, red}}, side)) == 0);
  CHECK(red_pixels(scene_of({{{0.5, 0.5, 0}, 0.2, red}}, side)) < 3 * whole / 4);
  // The edge at the front stands before a ball behind it, and is hidden by a ball before it.
  const Camera camera = camera_on_unit_cube(side);
  const Point middle = camera.project({1, 0, 0.5});
  const auto is_red_at = [&](const Image& image, double dx) {
    return is_red(image.at(static_cast<int>(std::lround(middle.x + dx)), static_cast<int>(std::lround(middle.y))));
  };
  const Image behind = scene_of({{{0.9, 0.1, 0.5}, 0.08, red}}, side),
              before = scene_of({{{1.1, -0.1, 0.5}, 0.08, red}}, side);
  CHECK_FALSE(is_red_at(behind, -0.5));
  CHECK(is_red_at(before, -0.5));
}

TEST_CASE("a scene of two tiles has no seam", "[figures]") {
  const int side = 2600;
  const Image image = scene_of({{{0.5, 0.5, 0.2}, 0.3, {1, 0.1, 0.1}}}, side);
  const auto jumps = [&](int y) {
    std::size_t count = 0;
    for (int x = 0; x < side; ++x) count += std::abs(image.at(x, y)[1] - image.at(x, y + 1)[1]) > 24;
    return count;
  };
  std::size_t red = 0;
  for (int x = 0; x < side; ++x) red += is_red(image.at(x, 1900));
  CHECK(red > 100);
  CHECK(jumps(2047) <= 2 * jumps(2046) + 10);
  std::size_t across = 0;
  for (int y = 0; y < side; ++y) across += is_red(image.at(2047, y)) != is_red(image.at(2048, y));
  CHECK(across < 10);
}

TEST_CASE("a scene without balls, and one of balls that cannot be seen", "[figures]") {
  const Image none = scene_of({}, 200);
  CHECK(red_pixels(none) == 0);
  const Colour red{1, 0, 0};
  CHECK(scene_of({{{0.5, -40, 0.5}, 0.1, red}, {{0.5, 0.5, 0.5}, 0, red}, {{90, 90, 0.5}, 0.1, red}}, 200).rgb ==
        none.rgb);
}

TEST_CASE("specks that share a side leave no gap and do not overlap", "[figures]") {
  Tile tile;
  const SpeckPainter painter(tile.view, {0, 0, 100, 100});
  // A sheared lattice: each sample of its inside belongs to exactly one of its cells.
  const Point origin{14.1, 8.3}, a{1.37, 0.41}, b{-0.29, 1.21};
  const auto corner = [&](int i, int j) -> Point {
    return {origin.x + i * a.x + j * b.x, origin.y + i * a.y + j * b.y};
  };
  std::size_t sum = 0;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      Tile alone;
      const std::array<Point, 4> cell{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
      SpeckPainter(alone.view, {0, 0, 100, 100}).fill(cell, {1, 0, 0});
      sum += alone.count({255, 0, 0});
      painter.fill(cell, {1, 0, 0});
    }
  Tile whole;
  SpeckPainter(whole.view, {0, 0, 100, 100})
      .fill({corner(0, 0), corner(12, 0), corner(12, 12), corner(0, 12)}, {1, 0, 0});
  CHECK(sum > 1000);
  CHECK(tile.count({255, 0, 0}) == sum);
  CHECK(tile.rgba == whole.rgba);
}

TEST_CASE("specks are painted at their true place, in either turn, within the clip", "[figures]") {
  Tile tile;
  const SpeckPainter painter(tile.view, {10, 6, 20, 30});
  painter.fill({{{9, 7}, {12, 7}, {12, 9}, {9, 9}}}, {0, 1, 0});  // a third of it is left of the clip
  painter.fill({{{15, 12}, {15, 14}, {17, 14}, {17, 12}}}, {0, 0, 1});
  painter.fill({{{60, 60}, {61, 60}, {61, 61}, {60, 61}}}, {1, 1, 1});
  CHECK(tile.count({0, 255, 0}) == 2 * 2 * 9);
  CHECK(tile.count({0, 0, 255}) == 2 * 2 * 9);
  CHECK(tile.count({255, 255, 255}) == 0);
  const std::uint8_t* first = tile.view.at((15 - 8) * 3, (12 - 4) * 3);
  CHECK(first[2] == 255);
  CHECK((first - 4)[2] == 0);
}
