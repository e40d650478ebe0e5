// Contact normals against closed forms: where densities turn one, where they do not, what curved and turned surfaces cost,
// and that a normal for each body breaks momentum.

#include <cmath>
#include <numbers>

#include "simulation/normal_errors.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;

namespace {

constexpr double degree = std::numbers::pi / 180;

Component component(mpm_kind kind, const char* id) {
  Component chosen;
  chosen.plugin = test::plugins().find(kind, id);
  REQUIRE(chosen.plugin);
  chosen.parameters.resize((chosen.plugin->descriptor->parameter_bytes + 7) / 8);
  for (const mpm_parameter& parameter : chosen.plugin->parameters())
    chosen.parameters[parameter.offset / sizeof(double)] = parameter.default_value;
  return chosen;
}

/// The direction, degrees from x, of the normal between two bodies with these gradients of volume and densities.
double direction(const char* id, const Vector3& of_a, const Vector3& of_b, double density_a, double density_b) {
  const Component normal = component(MPM_NORMAL, id);
  constexpr std::size_t n = MPM_LANES;
  std::array<double, 2 * n> mass_a, mass_b, volume_a, volume_b, out, own_a, own_b;
  std::array<std::int32_t, n> found{};
  for (std::size_t k = 0; k < 2 * n; ++k) {
    volume_a[k] = of_a[k / n], volume_b[k] = of_b[k / n];
    mass_a[k] = density_a * volume_a[k], mass_b[k] = density_b * volume_b[k];
  }
  const mpm_normal_batch batch{n,
                               n,
                               2,
                               0,
                               mass_a.data(),
                               mass_b.data(),
                               volume_a.data(),
                               volume_b.data(),
                               out.data(),
                               own_a.data(),
                               own_b.data(),
                               found.data()};
  normal.plugin->normal().from_sums[MPM_SCALAR_DOUBLE][0](normal.parameters.data(), &batch);
  REQUIRE(found[0] == 1);
  return std::atan2(out[n], out[0]) / degree;
}

double error_on_face(const char* id, int particles, double ratio, double angle, bool turned) {
  return normal_errors(component(MPM_NORMAL, id), component(MPM_SHAPE, "bspline_quadratic"),
                       {TouchingSurface::face, particles, ratio, 8, turned}, {angle}, 64)[0]
      .rms;
}

/// Two discs that meet off their centres' line.
std::string colliding(const std::string& normal) {
  return R"({"title": "t", "dimension": 2, "backend": "cpu", "precision": "double",
    "grid": {"cell_size": 0.05, "domain": [[0, 0], [2, 2]]},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "contact": {"type": "coulomb", "friction": 0.2, "normal": ")" +
         normal + R"("},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [
      {"name": "a", "material": "m", "geometry": {"type": "ball", "centre": [0.72, 0.9], "radius": 0.25},
       "velocity": [0.4, 0]},
      {"name": "b", "material": "m", "geometry": {"type": "ball", "centre": [1.24, 1.1], "radius": 0.25},
       "velocity": [-0.4, 0]}],
    "solver": {"time_step": 1e-3, "end_time": 0.3}})";
}

struct Collision {
  double residual = 0;  ///< sum over steps of what contact changed the total momentum by, kg m/s
  double impulse = 0;   ///< sum of the contact force times the step
  Vector3 change{};     ///< of the particles' momentum
};

Collision collide(const std::string& normal) {
  test::Scene scene(colliding(normal));
  const Totals before = scene.metrics.measure();
  Collision found;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    const ContactRecord& record = scene.simulation.backend().contact_record();
    found.residual += record.momentum_residual;
    found.impulse += scene.simulation.last_time_step() * std::hypot(record.force[0], record.force[1]);
  }
  const Totals after = scene.metrics.measure();
  for (std::size_t c = 0; c < 2; ++c) found.change[c] = after.momentum[c] - before.momentum[c];
  return found;
}

}  // namespace

TEST_CASE("mass and volume normals agree at one density, and differ by the closed form at two", "[normals]") {
  // About a corner, gradients of unit size along x and, of b, along -y: the mean is at 45 degrees.
  const Vector3 of_a{1, 0, 0}, of_b{0, -1, 0};
  CHECK(direction("average_volume_gradient", of_a, of_b, 1, 100) == Approx(45).epsilon(1e-14));
  CHECK(direction("mass_gradient", of_a, of_b, 7, 7) == Approx(45).epsilon(1e-14));
  for (const double ratio : {0.01, 0.5, 3.0, 100.0})
    CHECK(direction("mass_gradient", of_a, of_b, 1, ratio) == Approx(std::atan(ratio) / degree).epsilon(1e-13));
  CHECK(direction("mass_gradient", of_a, of_b, 1, 100) == Approx(89.42706).epsilon(1e-7));
}

TEST_CASE("the volume gradient of one body is that of the larger, and of both where they are equal", "[normals]") {
  CHECK(direction("volume_gradient", {2, 0, 0}, {0, -1, 0}, 1, 1) == Approx(0).margin(1e-14));
  CHECK(direction("volume_gradient", {1, 0, 0}, {0, -2, 0}, 1, 1) == Approx(90).epsilon(1e-14));
  CHECK(direction("volume_gradient", {1, 0, 0}, {0, -1, 0}, 1, 1) == Approx(45).epsilon(1e-14));
  CHECK(direction("own_gradient", {5, 0, 0}, {0, -1, 0}, 1, 1) == Approx(45).epsilon(1e-14));
}

TEST_CASE("along the grid every normal of a flat face is right", "[normals]") {
  for (const Plugin* plugin : test::plugins().of_kind(MPM_NORMAL)) {
    if (plugin->id() == "given") continue;
    INFO(plugin->id());
    for (const double ratio : {1.0, 100.0}) CHECK(error_on_face(plugin->descriptor->id, 2, ratio, 0, false) < 1e-5);
  }
}

TEST_CASE("densities turn the normal of mass gradients alone, and not between bodies that fill the plane",
          "[normals]") {
  for (const int particles : {2, 4}) {
    // The few nodes that one body hardly reaches count or not by its mass. On one lattice a partition of unity makes the gradients opposite: no density turns their difference.
    const double filled = error_on_face("average_volume_gradient", particles, 1, 20, false);
    CHECK(error_on_face("mass_gradient", particles, 100, 20, false) == Approx(filled).epsilon(0.01));
    CHECK(error_on_face("own_gradient", particles, 1, 20, false) == Approx(filled).epsilon(1e-9));
    const double volume = error_on_face("average_volume_gradient", particles, 1, 20, true);
    CHECK(error_on_face("mass_gradient", particles, 1, 20, true) == Approx(volume).epsilon(1e-12));
    // Of two bodies that lie as they like the errors are independent: their mean has 1 / sqrt 2 of one body's.
    const double one_body = std::numbers::sqrt2 * volume;
    CHECK(error_on_face("mass_gradient", particles, 100, 20, true) == Approx(one_body).epsilon(0.1));
    CHECK(error_on_face("mass_gradient", particles, 0.01, 20, true) == Approx(one_body).epsilon(0.1));
    CHECK(error_on_face("own_gradient", particles, 1, 20, true) == Approx(one_body).epsilon(0.1));
  }
}

// A half plane under a block that ends: a node above the corner sees half a plane of the one and a quarter of the other.
TEST_CASE("at a block's end the widest gap alone is right", "[normals]") {
  const auto error = [](const char* id) {
    return normal_errors(component(MPM_NORMAL, id), component(MPM_SHAPE, "bspline_quadratic"),
                         {TouchingSurface::end_of_block, 2, 1, 8, false}, {0})[0]
        .rms;
  };
  CHECK(error("widest_gap") < 1e-6);
  for (const char* id : {"average_volume_gradient", "mass_gradient", "volume_gradient", "own_gradient"}) {
    INFO(id);
    CHECK(error(id) > 5);
  }
}

TEST_CASE("errors of normals refuse shapes and numbers that they do not know", "[normals]") {
  const Component normal = component(MPM_NORMAL, "widest_gap"), splines = component(MPM_SHAPE, "bspline_quadratic");
  CHECK_THROWS_AS(normal_errors(normal, component(MPM_SHAPE, "cpdi"), {}, {0}), std::invalid_argument);
  constexpr TouchingSurface face = TouchingSurface::face;
  CHECK_THROWS_AS(normal_errors(normal, splines, {face, 0}, {0}), std::invalid_argument);
  CHECK_THROWS_AS(normal_errors(normal, splines, {face, 2, 0}, {0}), std::invalid_argument);
  CHECK_THROWS_AS(normal_errors(normal, splines, {face, 2, 1, -1}, {0}), std::invalid_argument);
  CHECK_THROWS_AS(normal_errors(normal, splines, {}, {0}, 0), std::invalid_argument);
}

TEST_CASE("a normal for each body breaks momentum, and one for both keeps it", "[normals]") {
  for (const Plugin* plugin : test::plugins().of_kind(MPM_NORMAL)) {
    const std::string id(plugin->id());
    if (id == "given") continue;
    INFO(id);
    const Collision found = collide(id);
    REQUIRE(found.impulse > 1);
    const double change = std::hypot(found.change[0], found.change[1]);
    if (id != "own_gradient") {
      CHECK(found.residual < 1e-10 * found.impulse);
      CHECK(change < 1e-10 * found.impulse);
      continue;
    }
    // What particles gain in all is at most what the record says of each step.
    CHECK(found.residual > 0.01 * found.impulse);
    CHECK(change > 1e-3 * found.impulse);
    CHECK(change <= found.residual * (1 + 1e-9));
  }
}
