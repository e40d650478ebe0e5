#include <cmath>
#include <limits>

#include "experiment/geometry.hpp"
#include "support/catch.hpp"

using namespace mpm;

namespace {
/// Area by counting points of a fine lattice over [0, 1]^2.
double area(const Geometry& geometry) {
  constexpr int n = 400;
  int inside = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) inside += geometry.contains({(i + 0.5) / n, (j + 0.5) / n, 7.0});
  }
  return inside / double(n * n);
}
const double pi = std::acos(-1.0);
}  // namespace

TEST_CASE("areas in 2-D, where z does not count", "[geometry]") {
  const auto ball = make_ball(2, {0.5, 0.5, 0}, 0.3);
  const auto box = make_box(2, {0.1, 0.2, 0}, {0.6, 0.9, 0});
  CHECK(area(*ball) == Approx(pi * 0.09).epsilon(0.01));
  CHECK(area(*box) == Approx(0.35).epsilon(0.01));
  CHECK(area(*make_ring(2, {0.5, 0.5, 0}, 0.2, 0.4, 0, 0)) == Approx(pi * 0.12).epsilon(0.01));
  CHECK(area(*make_polygon({{0, 0, 0}, {1, 0, 0}, {0.5, 0.5, 0}, {1, 1, 0}, {0, 1, 0}})) == Approx(0.75).epsilon(0.01));
  CHECK(area(*make_half_space(2, {0.25, 0, 0}, {2, 0, 0})) == Approx(0.25).epsilon(0.01));
  const double both = area(*make_intersection({ball, box}));
  CHECK(area(*make_union({ball, box})) == Approx(area(*ball) + area(*box) - both));
  CHECK(area(*make_difference({ball, box})) == Approx(area(*ball) - both));
}

TEST_CASE("a ring in 3-D is a tube along its axis", "[geometry]") {
  const auto tube = make_ring(3, {0, 0, 1}, 0.5, 1, 2, 4);
  CHECK(tube->contains({0.7, 0, 2.9}));
  CHECK_FALSE(tube->contains({0.7, 0, 3.1}));
  CHECK_FALSE(tube->contains({0.3, 0, 1}));
  CHECK(tube->bounds() == std::pair<Vector3, Vector3>({-1, -1, -1}, {1, 1, 3}));
}

TEST_CASE("bounds enclose, and only a half space has none", "[geometry]") {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto half = make_half_space(2, {0, 0.5, 0}, {0, 1, 0});
  CHECK(half->bounds() == std::pair<Vector3, Vector3>({-infinity, -infinity, 0}, {infinity, 0.5, 0}));
  const auto ball = make_ball(2, {0, 1, 0}, 1);
  CHECK(make_intersection({ball, half})->bounds() == std::pair<Vector3, Vector3>({-1, 0, 0}, {1, 0.5, 0}));
  CHECK(make_difference({ball, half})->bounds() == ball->bounds());
  CHECK(make_polygon({{0, 0, 0}, {2, 0, 0}, {1, 3, 0}})->bounds() == std::pair<Vector3, Vector3>({0, 0, 0}, {2, 3, 0}));
}

TEST_CASE("polygons that cross or touch themselves are found", "[geometry]") {
  using Edges = std::pair<int, int>;
  CHECK(crossing_edges({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) == Edges{-1, -1});
  CHECK(crossing_edges({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}) == Edges{0, 2});
  CHECK(crossing_edges({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}}) == Edges{0, 1});
  CHECK(crossing_edges({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0, 0}, {0, 2, 0}}) == Edges{0, 2});
  CHECK(crossing_edges({{0, 0, 0}, {0, 0, 0}, {1, 1, 0}}) != Edges{-1, -1});
  CHECK(crossing_edges({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}) == Edges{-1, -1});
  CHECK(polygon_area({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}) == Approx(1));
}
