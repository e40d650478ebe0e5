// Where particles are placed, against closed forms of volume and middle: 8 cells a diameter, 2 particles a cell and axis.

#include "experiment/places.hpp"

#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>

#include "experiment/mask.hpp"
#include "experiment/measure.hpp"
#include "experiment/surface_mesh.hpp"
#include "support/catch.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double pi = std::numbers::pi, cell = 0.1;

GridSpecification grid_of(int dimension, Symmetry symmetry = Symmetry::plane_strain) {
  GridSpecification grid;
  grid.cell_size = cell, grid.symmetry = symmetry;
  for (int c = 0; c < dimension; ++c) grid.lower[c] = 0, grid.upper[c] = 2, grid.cells[c] = 20;
  return grid;
}

Places places_of(int dimension, GeometryPointer geometry, SeedingKind kind,
                 Symmetry symmetry = Symmetry::plane_strain) {
  BodySpecification body;
  body.geometry = std::move(geometry);
  body.seeding.kind = kind;
  const GridSpecification grid = grid_of(dimension, symmetry);
  return place_particles({grid, dimension, 7}, body);
}

struct Sum {
  double volume = 0;
  Vector3 middle{};
  double lightest = INFINITY;
};

Sum sum_of(const Places& places) {
  Sum sum;
  for (std::size_t p = 0; p < places.points.size(); ++p) {
    const double share = places.shares.empty() ? 1 : places.shares[p];
    sum.volume += share * places.volume;
    sum.lightest = smaller(sum.lightest, share);
    for (int c = 0; c < 3; ++c) sum.middle[c] += share * places.volume * places.points[p][c];
  }
  for (double& x : sum.middle) x /= sum.volume;
  return sum;
}

/// Volume to 1e-4, middle to 1e-4 cells.
void check(const Places& places, double volume, const Vector3& middle, int dimension) {
  const Sum sum = sum_of(places);
  CHECK(std::abs(sum.volume / volume - 1) < 1e-4);
  for (int c = 0; c < dimension; ++c) CHECK(std::abs(sum.middle[c] - middle[c]) < 1e-4 * cell);
}

constexpr SeedingKind beside_lattice[] = {SeedingKind::fitted, SeedingKind::partial, SeedingKind::random,
                                          SeedingKind::blue_noise};

/// Places off the cells by irregular shares.
const Vector3 spots[] = {{1, 1, 1}, {1.0125, 0.9875, 1.0375}, {0.9713, 1.0291, 0.9871}};

}  // namespace

TEST_CASE("the share behind a plane is that of the unit square and cube", "[geometry]") {
  CHECK(share_behind_plane(2, 0, {1, 0, 0}) == Approx(0.5).margin(1e-6));
  CHECK(share_behind_plane(2, -0.25, {1, 0, 0}) == Approx(0.75).epsilon(1e-3));
  CHECK(share_behind_plane(2, 0.5, {1, 1, 0}) == Approx(0.125).epsilon(1e-9));  // a corner of half a side
  CHECK(share_behind_plane(3, 1.0, {1, 1, 1}) == Approx(0.125 / 6).epsilon(1e-9));
  CHECK(share_behind_plane(3, -2, {1, 1, 1}) == 1);
  CHECK(share_behind_plane(3, 2, {1, 1, 1}) == 0);
}

TEST_CASE("a disc and a ball have their mass and centre however they are seeded and wherever they lie", "[geometry]") {
  for (const SeedingKind kind : beside_lattice)
    for (const Vector3& spot : spots) {
      INFO("seeding " << static_cast<int>(kind) << " at " << spot[0]);
      check(places_of(2, make_ball(2, spot, 0.4), kind), pi * 0.16, spot, 2);
      if (kind == SeedingKind::random && spot == spots[1]) continue;  // three dimensions once
      check(places_of(3, make_ball(3, spot, 0.4), kind), 4 * pi / 3 * 0.064, spot, 3);
    }
}

TEST_CASE("rings, turned boxes and what is cut out have their mass and centre", "[geometry]") {
  const Vector3 z{0, 0, 1}, at = spots[2];
  const auto box = make_box(2, {0.7, 0.8, 0}, {1.3, 1.2, 0});
  const auto turned = make_placed(box, rotation_about(z, 0.3), {1, 1, 0}, {0.013, 0.021, 0});
  const auto holed = make_difference({turned, make_ball(2, {1.013, 1.021, 0}, 0.11)});
  for (const SeedingKind kind : beside_lattice) {
    INFO("seeding " << static_cast<int>(kind));
    check(places_of(2, make_ring(2, at, 0.15, 0.4, 0, 0), kind), pi * (0.16 - 0.0225), at, 2);
    check(places_of(2, turned, kind), 0.24, {1.013, 1.021, 0}, 2);
    check(places_of(2, holed, kind), 0.24 - pi * 0.0121, {1.013, 1.021, 0}, 2);
  }
  check(places_of(3, make_ring(3, at, 0, 0.4, 1, 0.55), SeedingKind::partial), pi * 0.16 * 0.55, at, 3);
  const auto cube =
      make_placed(make_box(3, {0.7, 0.7, 0.7}, {1.3, 1.2, 1.3}), rotation_about({1, 2, 3}, 0.7), {1, 0.95, 1}, {});
  check(places_of(3, cube, SeedingKind::partial), 0.18, {1, 0.95, 1}, 3);
}

TEST_CASE("a lattice fitted to a box fills it with equal particles that turn with it", "[geometry]") {
  const auto box = make_box(2, {0.71, 0.83, 0}, {1.28, 1.19, 0});
  const Places straight = places_of(2, box, SeedingKind::fitted);
  CHECK(straight.points.size() == 11 * 7);  // 0.57 / 0.05 and 0.36 / 0.05 rows, rounded
  CHECK(straight.shares.empty());
  CHECK(sum_of(straight).volume == Approx(0.57 * 0.36).epsilon(1e-13));
  CHECK(straight.points[0][0] == Approx(0.71 + 0.57 / 22).epsilon(1e-13));
  const auto turn = rotation_about({0, 0, 1}, 0.4);
  const Places turned = places_of(2, make_placed(box, turn, {1, 1, 0}, {0.02, 0, 0}), SeedingKind::fitted);
  REQUIRE(turned.points.size() == straight.points.size());
  for (std::size_t p = 0; p < turned.points.size(); ++p) {
    const double dx = straight.points[p][0] - 1, dy = straight.points[p][1] - 1;
    CHECK(turned.points[p][0] == Approx(1.02 + std::cos(0.4) * dx - std::sin(0.4) * dy).epsilon(1e-12));
    CHECK(turned.points[p][1] == Approx(1 + std::sin(0.4) * dx + std::cos(0.4) * dy).epsilon(1e-12));
  }
  // The columns of the boxes are the turned semi-sides.
  CHECK(turned.boxes[0] == Approx(0.57 / 22 * std::cos(0.4)).epsilon(1e-12));
  CHECK(turned.boxes[2] == Approx(0.57 / 22 * std::sin(0.4)).epsilon(1e-12));
}

TEST_CASE("no partial particle is lighter than said, whole ones are those of the lattice, and boxes hold the volume",
          "[geometry]") {
  const Places places = places_of(2, make_ball(2, spots[2], 0.4), SeedingKind::partial);
  std::size_t whole = 0;
  for (std::size_t p = 0; p < places.points.size(); ++p) {
    CHECK(places.shares[p] >= 0.05);
    const double* const box = &places.boxes[4 * p];
    CHECK(4 * (box[0] * box[3] - box[1] * box[2]) == Approx(places.shares[p] * places.volume).epsilon(1e-9));
    if (places.shares[p] != 1) continue;
    ++whole;
    const double row = places.points[p][0] / 0.05 - 0.5;
    CHECK(std::abs(row - std::round(row)) < 1e-9);
    CHECK(box[0] == Approx(0.025).epsilon(1e-9));
  }
  CHECK(whole > places.points.size() / 2);
}

TEST_CASE("what a partial lattice sums changes smoothly as a body moves through a cell", "[geometry]") {
  // Sums over all particles that know of the rim: the second moment about the middle, and the count times the lattice's.
  const double exact = pi * std::pow(0.4, 4) / 4;
  double before = 0;
  for (int k = 0; k <= 32; ++k) {
    const Vector3 spot{1 + 0.1 * k / 32, 1.003, 0};
    const Places places = places_of(2, make_ball(2, spot, 0.4), SeedingKind::partial);
    double second = 0;
    for (std::size_t p = 0; p < places.points.size(); ++p) {
      const double box = std::pow(places.boxes[4 * p], 2) / 3;
      second += places.shares[p] * places.volume * (std::pow(places.points[p][0] - spot[0], 2) + box);
    }
    CHECK(second == Approx(exact).epsilon(2e-4));
    if (k > 0) CHECK(std::abs(second - before) < 2e-4 * exact);
    before = second;
  }
}

TEST_CASE("rings around an axis have their volume", "[geometry][axisymmetric]") {
  // A half disc at the axis makes a ball; sizes are 2 pi r times the section.
  const auto half = make_intersection({make_ball(2, {0, 1.013, 0}, 0.4), make_box(2, {0, 0, 0}, {2, 2, 0})});
  for (const SeedingKind kind : beside_lattice) {
    INFO("seeding " << static_cast<int>(kind));
    const Places places = places_of(2, half, kind, Symmetry::axisymmetric);
    double volume = 0;
    for (std::size_t p = 0; p < places.points.size(); ++p)
      volume += 2 * pi * places.points[p][0] * places.volume * (places.shares.empty() ? 1 : places.shares[p]);
    CHECK(volume == Approx(4 * pi / 3 * 0.064).epsilon(1e-4));
  }
}

TEST_CASE("the same seed throws the same points, another one others; blue noise keeps its distance", "[geometry]") {
  const auto disc = make_ball(2, {1, 1, 0}, 0.4);
  CHECK(places_of(2, disc, SeedingKind::random).points == places_of(2, disc, SeedingKind::random).points);
  BodySpecification body;
  body.geometry = disc, body.seeding.kind = SeedingKind::random;
  const GridSpecification grid = grid_of(2);
  CHECK(place_particles({grid, 2, 8}, body).points != place_particles({grid, 2, 7}, body).points);
  const auto nearest = [](const Places& places) {
    double least = INFINITY;
    for (std::size_t p = 0; p < places.points.size(); ++p)
      for (std::size_t q = 0; q < p; ++q)
        least = smaller(
            least, std::hypot(places.points[p][0] - places.points[q][0], places.points[p][1] - places.points[q][1]));
    return least / 0.05;
  };
  CHECK(nearest(places_of(2, disc, SeedingKind::random)) < 0.3);
  CHECK(nearest(places_of(2, disc, SeedingKind::blue_noise)) > 0.6);
}

namespace {

/// A sphere of triangles, 40 rows of 80, as a text or binary STL file.
void write_sphere(const std::filesystem::path& path, bool text, double radius, const Vector3& at, int skipped = -1) {
  std::vector<Triangle> triangles;
  const auto point = [&](int i, int j) -> Vector3 {
    const double u = pi * i / 40, v = 2 * pi * (j % 80) / 80, s = i == 0 || i == 40 ? 0 : std::sin(u);
    // The file's numbers are floats.
    return {static_cast<float>(at[0] + radius * s * std::cos(v)), static_cast<float>(at[1] + radius * s * std::sin(v)),
            static_cast<float>(at[2] + radius * std::cos(u))};
  };
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 80; ++j) {
      if (i > 0) triangles.push_back({point(i, j), point(i + 1, j), point(i, j + 1)});
      if (i < 39) triangles.push_back({point(i, j + 1), point(i + 1, j), point(i + 1, j + 1)});
    }
  if (skipped >= 0) triangles.erase(triangles.begin() + skipped);
  std::ofstream out(path, std::ios::binary);
  out.precision(9);
  if (text) {
    out << "solid ball\n";
    for (const Triangle& t : triangles) {
      out << "facet normal 0 0 0\nouter loop\n";
      for (const Vector3& x : t) out << "vertex " << x[0] << " " << x[1] << " " << x[2] << "\n";
      out << "endloop\nendfacet\n";
    }
    out << "endsolid ball\n";
    return;
  }
  const auto count = static_cast<std::uint32_t>(triangles.size());
  out << std::string(80, ' ');
  out.write(reinterpret_cast<const char*>(&count), 4);
  for (const Triangle& t : triangles) {
    float numbers[12] = {};
    for (std::size_t c = 0; c < 9; ++c) numbers[3 + c] = static_cast<float>(t[c / 3][c % 3]);
    out.write(reinterpret_cast<const char*>(numbers), 48);
    out.write("\0\0", 2);
  }
}

/// Volume and middle of what triangles enclose, by tetrahedra from the origin.
Sum enclosed(const std::vector<Triangle>& triangles) {
  Sum sum;
  for (const Triangle& t : triangles) {
    const double volume =
        (t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[2][1]) + t[0][1] * (t[1][2] * t[2][0] - t[1][0] * t[2][2]) +
         t[0][2] * (t[1][0] * t[2][1] - t[1][1] * t[2][0])) /
        6;
    sum.volume += volume;
    for (int c = 0; c < 3; ++c) sum.middle[c] += volume * (t[0][c] + t[1][c] + t[2][c]) / 4;
  }
  for (double& x : sum.middle) x /= sum.volume;
  return sum;
}

}  // namespace

TEST_CASE("a surface of triangles has its mass and centre, from text and from binary", "[geometry][stl]") {
  const TemporaryFolder folder;
  for (const bool text : {true, false}) {
    write_sphere(folder / "ball.stl", text, 400, {1013, 991, 1027});  // in mm
    SurfaceMesh surface = read_stl(folder / "ball.stl", 1e-3);
    CHECK(surface.is_text == text);
    CHECK(surface.triangles.size() == 2 * 80 * 39);
    check_closed(surface);
    const Sum exact = enclosed(surface.triangles);
    CHECK(exact.volume == Approx(4 * pi / 3 * 0.064).epsilon(5e-3));
    const GeometryPointer ball = make_enclosed(surface.triangles);
    CHECK(ball->contains({1.013, 0.991, 1.027}));
    CHECK(!ball->contains({1.013, 0.991, 1.43}));
    CHECK(ball->distance({1.013, 0.991, 1.527}) == Approx(0.1).epsilon(1e-4));
    CHECK(ball->distance({1.013, 0.991, 1.327}) == Approx(-0.1).epsilon(1e-2));
    if (text) check(places_of(3, ball, SeedingKind::partial), exact.volume, exact.middle, 3);
  }
}

TEST_CASE("files that are no closed surface are refused with their place", "[geometry][stl]") {
  const TemporaryFolder folder;
  const auto message = [&](const std::function<void()>& write) {
    write();
    try {
      check_closed(read_stl(folder / "s.stl", 1));
    } catch (const SurfaceError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto holding = [&](const std::string& text) {
    return [&folder, text] { std::ofstream(folder / "s.stl") << text; };
  };
  CHECK_THAT(message([&] {
               write_sphere(folder / "s.stl", true, 1, {0, 0, 0}, 500);
             }),
             ContainsSubstring("line ") && ContainsSubstring("the surface is not closed: 1 facet meets at the edge") &&
                 ContainsSubstring("there are 3 such edges"));
  CHECK_THAT(message([&] { write_sphere(folder / "s.stl", false, 1, {0, 0, 0}, 500); }), ContainsSubstring("byte "));
  CHECK_THAT(message(holding("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n")),
             ContainsSubstring("line 4: expected \"vertex\" and three numbers"));
  CHECK_THAT(message(holding("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nendloop\nendfacet\nendsolid\n")),
             ContainsSubstring("line 6: a facet of 1 corners"));
  CHECK_THAT(message(holding("solid a\nfacets\n")), ContainsSubstring("line 2: \"facets\" has no meaning in STL"));
  CHECK_THAT(message(holding("solid a\n")), ContainsSubstring("ends before \"endsolid\""));
  CHECK_THAT(message(holding("nothing")), ContainsSubstring("it is no STL file"));
  CHECK_THAT(message(holding(std::string(80, ' ') + std::string("\x02\0\0\0", 4) + std::string(50, '\0'))),
             ContainsSubstring("byte 134: the file ends here, and its 2 facets take 184 bytes"));
}

TEST_CASE("a picture's dark parts are the body", "[geometry][mask]") {
  // A disc of 30 pixels in a picture of 100, out of focus: its edge is four pixels wide.
  Picture picture;
  picture.width = picture.height = 100;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x)
      picture.darkness.push_back(std::clamp((30 - std::hypot(x + 0.5 - 52, y + 0.5 - 47)) / 4 + 0.5, 0.0, 1.0));
  const auto disc = make_mask(picture, {0.5, 0.5, 0}, {1.5, 1.5, 0}, 0.5, false);
  CHECK(disc->contains({1.02, 1.03, 0}));
  CHECK(!disc->contains({1.02, 1.34, 0}));
  CHECK(!disc->contains({0.4, 1, 0}));
  const Sum sum = sum_of(places_of(2, disc, SeedingKind::partial));
  CHECK(sum.volume == Approx(pi * 0.09).epsilon(1e-3));
  CHECK(std::abs(sum.middle[0] - 1.02) < 1e-3 * cell);
  CHECK(std::abs(sum.middle[1] - 1.03) < 1e-3 * cell);  // rows come from the top
  const Sum rest =
      sum_of(places_of(2, make_mask(picture, {0.5, 0.5, 0}, {1.5, 1.5, 0}, 0.5, true), SeedingKind::partial));
  CHECK(rest.volume == Approx(1 - pi * 0.09).epsilon(1e-3));
}
