// The plane with the widest gap between two clouds of points: no other direction has a wider one. And the normal that is given.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "normals/given/given.hpp"
#include "normals/widest_gap/widest_gap.hpp"
#include "plugin/sdk/points.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

using Vector3 = std::array<double, 3>;

/// The plane that is found between two clouds, and the gap along its normal.
struct Plane {
  bool found = false;
  Vector3 normal{};
  double gap = 0;
};

/// Points as a plugin gets them: lane by lane, the first once more in those that are left over.
struct Row {
  std::vector<double> places;
  std::uint32_t stride;

  explicit Row(const std::vector<Vector3>& points)
      : stride((static_cast<std::uint32_t>(points.size()) + MPM_LANES - 1) / MPM_LANES * MPM_LANES) {
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < stride; ++k) places.push_back(points[k < points.size() ? k : 0][c]);
  }
};

double along(const Vector3& n, const Vector3& x) {
  return n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
}

/// Two clouds, and the gap between them along any direction from a to b.
struct Clouds {
  std::vector<Vector3> a, b;

  double gap(const Vector3& normal) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vector3& x : a) high = larger(high, along(normal, x));
    for (const Vector3& x : b) low = smaller(low, along(normal, x));
    return low - high;
  }
  Plane plane(int dimension) const {
    const Row row_a(a), row_b(b);
    const mpm_normal_points points{static_cast<std::uint32_t>(a.size()),
                                   row_a.stride,
                                   static_cast<std::uint32_t>(b.size()),
                                   row_b.stride,
                                   row_a.places.data(),
                                   row_b.places.data(),
                                   nullptr,
                                   nullptr,
                                   nullptr};
    Plane found;
    found.found = dimension == 2 ? WidestGap::find<2>({}, sdk::clouds_of(points), found.normal.data())
                                 : WidestGap::find<3>({}, sdk::clouds_of(points), found.normal.data());
    found.gap = gap(found.normal);
    return found;
  }
};

Vector3 direction(std::mt19937& random, int dimension) {
  std::normal_distribution<double> normal;
  Vector3 n{};
  double squared = 0;
  for (int c = 0; c < dimension; ++c) n[c] = normal(random), squared += n[c] * n[c];
  for (double& component : n) component /= std::sqrt(squared);
  return n;
}

/// Points on both sides of a plane, at least half of `apart` from it.
Clouds beside_plane(std::mt19937& random, int dimension, const Vector3& normal, double apart, int count) {
  std::uniform_real_distribution<double> place(-2, 2);
  Clouds clouds;
  while (static_cast<int>(std::min(clouds.a.size(), clouds.b.size())) < count) {
    Vector3 x{};
    for (int c = 0; c < dimension; ++c) x[c] = place(random);
    const double side = along(normal, x);
    if (std::abs(side) < 0.5 * apart) continue;
    (side < 0 ? clouds.a : clouds.b).push_back(x);
  }
  return clouds;
}

}  // namespace

TEST_CASE("no direction has a wider gap than the plane that is found", "[separation]") {
  std::mt19937 random(7);
  for (const int dimension : {2, 3})
    for (const double apart : {1.0, 0.1, 1e-3})
      for (int scene = 0; scene < 40; ++scene) {
        const Vector3 between = direction(random, dimension);
        const Clouds clouds = beside_plane(random, dimension, between, apart, 3 + scene);
        const Plane found = clouds.plane(dimension);
        REQUIRE(found.found);
        CHECK(std::hypot(found.normal[0], found.normal[1], found.normal[2]) == Approx(1).epsilon(1e-12));
        CHECK(found.gap >= clouds.gap(between) * (1 - 1e-12));
        double widest = 0;
        for (int k = 0; k < 400; ++k) {  // all around, and close beside what was found
          Vector3 n = direction(random, dimension);
          const double share = k % 2 ? 1 : std::pow(0.5, k % 40);
          for (int c = 0; c < 3; ++c) n[c] = (1 - share) * found.normal[c] + share * n[c];
          const double length = std::hypot(n[0], n[1], n[2]);
          for (double& component : n) component /= length;
          widest = larger(widest, clouds.gap(n));
        }
        CHECK(widest <= found.gap * (1 + 1e-9));
      }
}

TEST_CASE("exchanged clouds have the opposite normal", "[separation]") {
  std::mt19937 random(8);
  for (const int dimension : {2, 3}) {
    const Clouds clouds = beside_plane(random, dimension, direction(random, dimension), 0.4, 30);
    const Plane one = clouds.plane(dimension), other = Clouds{clouds.b, clouds.a}.plane(dimension);
    for (int c = 0; c < 3; ++c) CHECK(one.normal[c] == Approx(-other.normal[c]).margin(1e-9));
    CHECK(one.gap == Approx(other.gap).epsilon(1e-12));
  }
}

// Rows of particles, two a cell, as they are about the end of a block that rests on a wider one.
TEST_CASE("rows of particles have the normal across them, at the end of a block too", "[separation]") {
  for (const double turned : {0.0, 17.0, 30.0, 45.0})
    for (const double end : {-0.75, -0.25, 0.25, 5.0}) {
      const double c = std::cos(turned * std::numbers::pi / 180), s = std::sin(turned * std::numbers::pi / 180);
      Clouds clouds;
      for (double x = -1.25; x < 1.5; x += 0.5)
        for (const double y : {0.25, 0.75, 1.25}) {
          clouds.a.push_back({c * x + s * y, s * x - c * y, 0});
          if (x <= end) clouds.b.push_back({c * x - s * y, s * x + c * y, 0});
        }
      const Plane found = clouds.plane(2);
      REQUIRE(found.found);
      CHECK(found.normal[0] == Approx(-s).margin(1e-12));
      CHECK(found.normal[1] == Approx(c).margin(1e-12));
      CHECK(found.gap == Approx(0.5).epsilon(1e-12));
    }
}

// The first two places that are looked at lie close beside each other; that the clouds are wide is found later.
TEST_CASE("clouds closer than a millionth of the farthest places that are compared count as meeting", "[separation]") {
  const auto clouds = [](double apart) {
    return Clouds{{{0, 0, 0}, {-1000, 2100, 0}}, {{apart, apart / 2, 0}, {2000, 2100 - apart / 2, 0}}};
  };
  CHECK_FALSE(clouds(1e-3).plane(2).found);
  CHECK(clouds(1e-2).plane(2).found);
}

// The first guess is the corner at 1 along z or y, and the next differs from it in this coordinate alone.
TEST_CASE("a place that differs from an earlier one in a single coordinate is another place", "[separation]") {
  const Plane in_y = Clouds{{{0, 0, 0}}, {{1, 1, 0}, {1, -0.2, 0}, {10, -1, 0}}}.plane(2);
  CHECK(in_y.normal[0] == Approx(1).epsilon(1e-12));
  const Plane in_z = Clouds{{{0, 0, 0}}, {{1, 0, 1}, {1, 0, -0.2}, {10, 0, -1}}}.plane(3);
  CHECK(in_z.normal[0] == Approx(1).epsilon(1e-12));
}

TEST_CASE("the plane is the same in any unit of length", "[separation]") {
  std::mt19937 random(11);
  for (const int dimension : {2, 3})
    for (const double apart : {0.5, 1e-3})
      for (const double unit : {0x1p-30, 0x1p30}) {
        const Clouds clouds = beside_plane(random, dimension, direction(random, dimension), apart, 20);
        Clouds scaled = clouds;
        for (std::vector<Vector3>* cloud : {&scaled.a, &scaled.b})
          for (Vector3& x : *cloud)
            for (double& component : x) component *= unit;
        const Plane one = clouds.plane(dimension), other = scaled.plane(dimension);
        REQUIRE((one.found && other.found));
        CHECK(one.normal == other.normal);
      }
}

TEST_CASE("of places equally far along a direction the first counts, in whichever lanes they are", "[separation]") {
  for (const int other : {4, 5, 8, 9, 14, 15}) {
    std::vector<Vector3> places(16, {0, 0, 0});
    places[3] = {1, -1, 0}, places[static_cast<std::size_t>(other)] = {1, 1, 0};
    const Row row(places);
    const sdk::CloudInLanes cloud{row.places.data(), nullptr, 16, row.stride};
    CHECK(cloud.farthest({1, 0, 0})[1] == -1);
  }
}

TEST_CASE("clouds that mix have no plane", "[separation]") {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-1, 1);
  for (const int dimension : {2, 3}) {
    Clouds mixed;
    for (int k = 0; k < 20; ++k)
      for (std::vector<Vector3>* cloud : {&mixed.a, &mixed.b})
        cloud->push_back({place(random), place(random), dimension == 3 ? place(random) : 0});
    CHECK_FALSE(mixed.plane(dimension).found);
    CHECK_FALSE(Clouds{{{0, 0, 0}}, {{0, 0, 0}}}.plane(dimension).found);  // one place
  }
  // A point inside a ring of others.
  Clouds ring{{{0.1, 0.2, 0}}, {}};
  for (int k = 0; k < 12; ++k) ring.b.push_back({std::cos(k * 0.5236), std::sin(k * 0.5236), 0});
  CHECK_FALSE(ring.plane(2).found);
}

TEST_CASE("a normal that is given is the unit vector along its components, in the plane without z", "[separation]") {
  NormalResult<3, double> in_space{};
  Given::find<3, double>({2, -3, 6}, {}, in_space);
  CHECK(in_space.found == 1);
  CHECK(in_space.normal[0] == Approx(2.0 / 7).epsilon(1e-15));
  CHECK(in_space.normal[1] == Approx(-3.0 / 7).epsilon(1e-15));
  CHECK(in_space.normal[2] == Approx(6.0 / 7).epsilon(1e-15));
  NormalResult<2, double> in_the_plane{};
  Given::find<2, double>({3, 4, 12}, {}, in_the_plane);
  CHECK(in_the_plane.normal[0] == Approx(0.6).epsilon(1e-15));
  CHECK(in_the_plane.normal[1] == Approx(0.8).epsilon(1e-15));
}
