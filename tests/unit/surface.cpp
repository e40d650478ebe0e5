// Surfaces of regions in pieces: areas, normals, and what is left of them where regions are combined.

#include <cmath>
#include <numbers>

#include "experiment/geometry.hpp"
#include "support/catch.hpp"

using namespace mpm;

namespace {

constexpr double pi = std::numbers::pi;
const std::pair<Vector3, Vector3> domain{{0, 0, 0}, {4, 4, 4}};

struct Sums {
  double area = 0;
  Vector3 normal{};   ///< integral of n, zero of a closed surface
  double volume = 0;  ///< integral of x . n over the dimension, by Gauss that of the region
};

Sums sums_of(const Geometry& region, int dimension, double spacing = 0.01) {
  Sums sums;
  for (const SurfacePiece& piece : region.surface(spacing, domain)) {
    CHECK(std::hypot(piece.normal[0], piece.normal[1], piece.normal[2]) == Approx(1).epsilon(1e-12));
    sums.area += piece.area;
    for (int c = 0; c < 3; ++c) {
      sums.normal[c] += piece.area * piece.normal[c];
      sums.volume += piece.area * piece.normal[c] * piece.point[c] / dimension;
    }
  }
  return sums;
}

void check_closed(const Sums& sums, double margin = 1e-12) {
  for (int c = 0; c < 3; ++c) CHECK(std::abs(sums.normal[c]) < margin);
}

}  // namespace

TEST_CASE("surfaces of simple regions have their areas, and enclose their volumes", "[surface]") {
  struct Case {
    const char* name;
    int dimension;
    GeometryPointer region;
    double area, volume, margin;
  };
  const double r = 0.35, R = 0.8, length = 1.3;
  for (const auto& [name, dimension, region, area, volume, margin] :
       {Case{"disc", 2, make_ball(2, {1, 2, 0}, r), 2 * pi * r, pi * r * r, 1e-4},
        Case{"ball", 3, make_ball(3, {1, 2, 1}, r), 4 * pi * r * r, 4 * pi / 3 * r * r * r, 1e-3},
        Case{"rectangle", 2, make_box(2, {0.1, 0.2, 0}, {1, 0.7, 0}), 2.8, 0.45, 1e-12},
        Case{"box", 3, make_box(3, {0.1, 0.2, 0.3}, {1, 0.7, 1}), 2 * (0.45 + 0.35 + 0.63), 0.315, 1e-12},
        Case{"ring", 2, make_ring(2, {1, 1, 0}, r, R, 2, 0), 2 * pi * (r + R), pi * (R * R - r * r), 1e-4},
        Case{"tube", 3, make_ring(3, {1, 1, 1}, r, R, 0, length), 2 * pi * ((r + R) * length + R * R - r * r),
             pi * (R * R - r * r) * length, 1e-4},
        Case{"triangle", 2, make_polygon({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}), 2 + std::sqrt(2), 0.5, 1e-12}}) {
    INFO(name);
    const Sums sums = sums_of(*region, dimension, 0.02);
    CHECK(sums.area == Approx(area).epsilon(1e-6));
    CHECK(sums.volume == Approx(volume).epsilon(margin));
    check_closed(sums);
  }
}

TEST_CASE("the surface of a combined region is what bounds the whole, once", "[surface]") {
  // A quarter of a ring, cut by the axes.
  const auto ring = make_ring(2, {0, 0, 0}, 0.5, 1, 2, 0), quadrant = make_box(2, {0, 0, 0}, {1, 1, 0});
  Sums sums = sums_of(*make_intersection({ring, quadrant}), 2);
  CHECK(sums.area == Approx(pi / 2 * 1.5 + 1).epsilon(1e-6));
  CHECK(sums.volume == Approx(pi / 4 * 0.75).epsilon(1e-4));
  check_closed(sums, 1e-4);
  // A block with a hole: the hole's normals point into it.
  sums = sums_of(*make_difference({make_box(2, {1, 1, 0}, {2, 2, 0}), make_ball(2, {1.5, 1.5, 0}, 0.3)}), 2);
  CHECK(sums.area == Approx(4 + 0.6 * pi).epsilon(1e-6));
  CHECK(sums.volume == Approx(1 - 0.09 * pi).epsilon(1e-4));
  // Two boxes that share a face, and one whose faces lie on another's.
  sums = sums_of(*make_union({make_box(2, {0, 0, 0}, {1, 1, 0}), make_box(2, {1, 0, 0}, {2, 1, 0})}), 2);
  CHECK(sums.area == Approx(6).epsilon(1e-9));
  CHECK(sums.volume == Approx(2).epsilon(1e-9));
  sums = sums_of(*make_union({make_box(2, {0, 0, 0}, {2, 1, 0}), make_box(2, {0, 0, 0}, {1, 1, 0})}), 2);
  CHECK(sums.area == Approx(6).epsilon(1e-9));
  check_closed(sums);
  // A ball cut in half by a plane that has no end of its own.
  sums = sums_of(*make_intersection({make_ball(3, {2, 2, 2}, 1), make_half_space(3, {2, 0, 0}, {-1, 0, 0})}), 3, 0.02);
  CHECK(sums.area == Approx(3 * pi).epsilon(1e-3));
  check_closed(sums, 5e-3);
}

TEST_CASE("the surface of a half space ends at the domain", "[surface]") {
  CHECK(sums_of(*make_half_space(2, {0, 1, 0}, {0, 2, 0}), 2).area == Approx(4).epsilon(1e-12));
  CHECK(sums_of(*make_half_space(2, {0, 0, 0}, {1, 1, 0}), 2).area == 0);
  CHECK(sums_of(*make_half_space(2, {2, 2, 0}, {1, 1, 0}), 2).area == Approx(4 * std::sqrt(2)).epsilon(1e-12));
  CHECK(sums_of(*make_half_space(3, {0, 1, 0}, {0, -2, 0}), 3, 0.1).area == Approx(16).epsilon(1e-12));
  CHECK(sums_of(*make_half_space(3, {0, 2, 2}, {0, 1, 1}), 3, 0.02).area == Approx(16 * std::sqrt(2)).epsilon(0.01));
}
