// The particles that a node sees where bodies meet: near it, beyond periodic faces and in the mirror of walls; and where
// their surfaces are.

#include "simulation/contact_points.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Two bodies on a grid of 10 by 10 cells; what is asked of contact stands in `contact`.
Experiment scene(const std::string& contact, const std::string& boundaries = R"({"all": "free"})") {
  return experiment_from(R"({"title": "touch", "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]], "boundaries": )" +
                         boundaries + R"(},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "contact": {)" +
                         contact + R"(},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0.3, "density": 1}},
    "bodies": [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0.2], "upper": [0.5, 0.5]}},
               {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0.5], "upper": [0.5, 0.8]}}],
    "solver": {"end_time": 1}})");
}

const std::string both = R"("type": "coulomb", "normal": "widest_gap", "detection": "particle_surfaces")";
const double round_particle[4] = {1, 0, 0, 1};

/// A node's view of particles given as places in cells, two a cell and axis.
struct View {
  const Experiment experiment;  // which the points refer to
  ContactPoints points;
  std::array<int, 3> node;

  View(Experiment given, const std::array<int, 3>& at) : experiment(std::move(given)), points(experiment), node(at) {
    points.begin();
    points.open(node);
  }
  void add(int field, double x, double y, const double* matrix = round_particle) {
    points.look_around({x, y, 0}, {x, y, 0});
    points.add(field, {x, y, 0}, matrix, 1, 0.25);
  }
  SeparatedPair pair() {
    points.find(0, points.node_count());
    return points.pair(node, 0, 1);
  }
  /// Between the surfaces along a normal, cells.
  double gap(const Vector3& normal) const {
    const SurfacePlaces surfaces = points.surfaces(node, 0, 1, normal);
    return surfaces.of_b - surfaces.of_a;
  }
};

}  // namespace

TEST_CASE("a node sees the particles less than a cell and a half away", "[contact_points]") {
  const Experiment experiment = scene(both);
  for (const double away : {1.49, 1.51}) {
    View view(experiment, {5, 5, 0});
    view.add(0, 5.1, 4.9), view.add(1, 5 + away, 5.2);
    CHECK(view.pair().found == (away < 1.5));
    CHECK(view.points.look_around({5, 5, 0}, {5, 5, 0}));
    CHECK_FALSE(view.points.look_around({8.5, 8.5, 0}, {9.5, 9.5, 0}));
  }
  View unasked(experiment, {5, 5, 0});
  CHECK_FALSE(unasked.points.pair({6, 5, 0}, 0, 1).found);
  CHECK_FALSE(ContactPoints(scene(R"("type": "coulomb")")).needed());
  CHECK_FALSE(ContactPoints(scene(R"("type": "coulomb", "normal": "widest_gap")")).sees_surfaces());
}

TEST_CASE("half the side of a particle is that of its square or cube, in cells", "[contact_points]") {
  CHECK(ContactPoints(scene(both)).half_side(0.0025) == Approx(0.25));  // 0.05 m of cells of 0.1 m
}

TEST_CASE("a node at a periodic face sees the particles at the other", "[contact_points]") {
  View view(scene(both, R"({"x_min": "periodic", "x_max": "periodic", "y_min": "free", "y_max": "free"})"), {0, 5, 0});
  view.add(0, 9.75, 5), view.add(1, 0.25, 5);
  const SeparatedPair pair = view.pair();
  REQUIRE(pair.parted);
  CHECK(pair.normal[0] == Approx(1));
  CHECK(view.gap(pair.normal) == Approx(0).margin(1e-13));
  CHECK(view.points.look_around({9, 4, 0}, {10, 6, 0}));
}

// A particle of a block at the upper face may have drifted over it since it was sorted, and is at the lower one then.
TEST_CASE("a node at a periodic face sees a particle that was looked for at the other", "[contact_points]") {
  const Experiment experiment =
      scene(both, R"({"x_min": "periodic", "x_max": "periodic", "y_min": "free", "y_max": "free"})");
  ContactPoints points(experiment);
  points.begin();
  for (const int x : {0, 9}) points.open({x, 5, 0});
  for (const auto& [field, y] : {std::pair{0, 4.75}, {1, 5.25}}) {
    points.look_around({7, 4, 0}, {11, 6, 0});
    points.add(field, {0.25, y, 0}, round_particle, 1, 0.25);
  }
  points.find(0, points.node_count());
  for (const int x : {0, 9}) {
    INFO(x);
    REQUIRE(points.pair({x, 5, 0}, 0, 1).parted);
    CHECK(points.pair({x, 5, 0}, 0, 1).normal[1] == Approx(1));
  }
}

TEST_CASE("a node at a wall sees the mirror of what lies before it", "[contact_points]") {
  // The nearest points of two particles that are one above the other and aside lie on the wall with their images.
  for (const std::string wall : {"slip", "stick", "separate", "free"}) {
    View view(scene(both, R"({"x_min": ")" + wall + R"(", "x_max": "free", "y_min": "free", "y_max": "free"})"),
              {0, 5, 0});
    view.add(0, 0.2, 4.75), view.add(1, 0.6, 5.25);
    const SeparatedPair pair = view.pair();
    REQUIRE(pair.parted);
    if (wall == "free")
      CHECK(pair.normal[0] == Approx(0.4 / std::hypot(0.4, 0.5)));
    else
      CHECK(pair.normal[0] == Approx(0).margin(1e-12));
  }
}

TEST_CASE("surfaces of particles touch where stretched rows do", "[contact_points]") {
  // Rows along a face that leans, of bodies that are stretched across it: half a spacing from centre to face.
  for (const double lean : {0.0, 15.0, 30.0, 45.0})
    for (const double stretch : {0.6, 1.0, 1.5})
      for (const double gap : {0.0, 0.1, -0.05}) {
        const double c = std::cos(lean * std::numbers::pi / 180), s = std::sin(lean * std::numbers::pi / 180);
        // F = I + (stretch - 1) n n, with n = (-s, c) from a to b.
        const double F[4] = {1 + (stretch - 1) * s * s, -(stretch - 1) * s * c, -(stretch - 1) * s * c,
                             1 + (stretch - 1) * c * c};
        View view(scene(both), {5, 5, 0});
        for (double along = -1; along < 1.1; along += 0.5)
          for (const double row : {0.25, 0.75}) {
            const double up = gap + stretch * row, down = -stretch * row;
            view.add(0, 5 + c * along - s * down, 5 + s * along + c * down, F);
            view.add(1, 5 + c * along - s * up, 5 + s * along + c * up, F);
          }
        const SeparatedPair pair = view.pair();
        INFO(lean << " degrees, stretched by " << stretch << ", gap " << gap);
        REQUIRE(pair.parted);
        CHECK(pair.normal[0] == Approx(-s).margin(1e-12));
        CHECK(pair.normal[1] == Approx(c).margin(1e-12));
        CHECK(view.gap(pair.normal) == Approx(gap).margin(1e-12));
      }
}

TEST_CASE("a sheared particle extends as its ellipsoid does, and its mirror image the other way", "[contact_points]") {
  const double sheared[4] = {1, 0.5, 0, 1};  // conjugate radii (1, 0) and (0.5, 1) times a quarter of a cell
  const Vector3 up{0, 1, 0}, across{0.6, 0.8, 0};
  for (const std::string wall : {"free", "slip"}) {
    View view(scene(both, R"({"x_min": ")" + wall + R"(", "x_max": "free", "y_min": "free", "y_max": "free"})"),
              {0, 5, 0});
    view.add(0, 0.3, 4.8, sheared), view.add(1, 0.3, 5.3, sheared);
    REQUIRE(view.pair().parted);
    CHECK(view.gap(up) == Approx(0.5 - 2 * 0.25).margin(1e-12));
    CHECK(view.points.surfaces(view.node, 0, 1, up).of_a == Approx(-0.2 + 0.25));  // of the node, which is at 5
    const double leans = 0.25 * std::hypot(0.6, 0.5 * 0.6 + 0.8), leans_back = 0.25 * std::hypot(0.6, -0.5 * 0.6 + 0.8);
    const double surface_a = 0.6 * 0.3 + 0.8 * 4.8 + leans;
    const double surface_b = wall == "free" ? 0.6 * 0.3 + 0.8 * 5.3 - leans : -0.6 * 0.3 + 0.8 * 5.3 - leans_back;
    CHECK(view.gap(across) == Approx(surface_b - surface_a).margin(1e-12));
  }
}

TEST_CASE("a normal or detection that nobody would look at is refused by name", "[contact_points]") {
  const auto refusal = [](const std::string& contact) -> std::string {
    try {
      scene(contact);
      return "accepted";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  CHECK(refusal(R"("type": "coulomb", "normal": "widest_gap")") == "accepted");
  CHECK_THAT(refusal(R"("type": "stick", "normal": "widest_gap")"),
             ContainsSubstring(
                 R"(/contact/normal: "stick" joins bodies at every node that they share and looks at no normal)"));
  CHECK_THAT(refusal(R"("type": "stick", "detection": "particle_surfaces")"),
             ContainsSubstring("/contact/detection: "));
  CHECK(refusal(R"("type": "stick", "normal": "average_volume_gradient")") == "accepted");
}
