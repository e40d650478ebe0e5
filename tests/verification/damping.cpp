// Damping of the nodes' motion: viscous, a force -c m v integrated exactly, and local (Cundall 1987), a share of the
// unbalanced force against the motion.

#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

std::string flying(int dimension) {
  const bool flat = dimension == 2;
  return R"J({"dimension": )J" + std::to_string(dimension) + R"J(, "grid": {"cell_size": 0.1, "domain": )J" +
         (flat ? "[[0, 0], [3, 1]]" : "[[0, 0, 0], [3, 1, 1]]") + R"J(, "boundaries": {"all": "free"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 100, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": )J" +
         (flat ? "[0.5, 0.5]" : "[0.5, 0.5, 0.5]") + R"J(, "radius": 0.23}, "velocity": )J" +
         (flat ? "[3, -0.2]" : "[3, -0.2, 0.1]") + R"J(}],
    "damping": {"viscous": 4}, "solver": {"time_step": 0.01, "end_time": 0.5}})J";
}

}  // namespace

TEST_CASE("a body that moves rigidly decays as exp(-c t)", "[damping]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const int dimension : {2, 3})
      for (const std::string transfer : {"pic", "flip", "apic", "mls", "asflip"})
        for (const std::string order : {"last", "first", "modified_last", "averaged"})
          for (const std::string filter : {"", R"({"type": "fmpm", "order": 2, "every_steps": 3})"}) {
            if (dimension == 3 && (order != "last" || !filter.empty())) continue;
            INFO(backend << " " << dimension << "-D " << transfer << " " << order << " " << filter);
            std::vector<std::string> overrides{set("/backend", backend), set("/transfer/type", transfer),
                                               set("/solver/stress_update", order)};
            if (!filter.empty()) overrides.push_back("/filter=" + filter);
            Scene scene(flying(dimension), overrides);
            const Totals start = scene.metrics.initial(), end = scene.run();
            const double left = std::exp(-4 * 0.5), step = std::exp(-4 * 0.01);
            // After each step of dt the velocity is less by exp(-c dt), and moves the body: a geometric series.
            const double way = 3 * 0.01 * step * (1 - left) / (1 - step);
            CHECK(end.momentum[0] == Approx(left * start.momentum[0]).epsilon(1e-11));
            CHECK(end.centre_of_mass[0] - start.centre_of_mass[0] == Approx(way).epsilon(1e-11));
            CHECK(scene.simulation.ledger().damping == Approx(end.kinetic - start.kinetic).epsilon(1e-10));
            CHECK(std::abs(scene.metrics.ledger_residual(end)) < 1e-11 * start.kinetic);
          }
}

TEST_CASE("a body falls with the share of gravity that local damping leaves", "[damping]") {
  for (const std::string backend : {"reference", "cpu"}) {
    Scene scene(flying(2), {set("/backend", backend), R"(/damping={"local": 0.3})", "/gravity=[0, -2]",
                            "/bodies/0/velocity=[0, 0]", "/solver/end_time=0.2"});
    const Totals start = scene.metrics.initial(), end = scene.run();
    CHECK(end.momentum[1] == Approx(-0.7 * 2 * 0.2 * start.mass).epsilon(1e-11));
    CHECK(std::abs(end.momentum[0]) < 1e-12 * start.mass);
    CHECK(std::abs(scene.simulation.ledger().damping + 0.3 * scene.simulation.ledger().gravity) < 1e-11 * end.kinetic);
    // Symplectic steps let a body fall by g dt v / 2 farther than its mean velocity.
    CHECK(std::abs(scene.metrics.ledger_residual(end)) < 1.1 * 0.5 * 2 * 0.01 * 0.28 * end.mass);
  }
}

// A wave along a periodic line of one particle a cell: particles lie midway between nodes and gather cos(theta/2) of a
// wave of phase theta a cell, and so does what they give. With FLIP and stress first nothing else loses energy; the map
// of velocity and strain of one wave has the determinant 1 - cos(theta/2)^2 (1 - exp(-c dt)), which goes to exp(-c dt) as
// the wave gets long: the amplitude falls by its root a step, as exp(-c t / 2).
TEST_CASE("a free oscillator decays as exp(-c t / 2)", "[damping]") {
  const double c = 3, dt = 0.01;
  for (const std::string backend : {"reference", "cpu"})
    for (const int cells : {8, 64}) {
      const std::string text = R"J({"dimension": 2, "backend": ")J" + backend + R"J(", "constants": {"L": )J" +
                               std::to_string(cells) + R"J(}, "grid": {"cell_size": 1, "domain": [[0, 0], [)J" +
                               std::to_string(cells) +
                               R"J(, 1]], "boundaries": {"all": "periodic"}},
        "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
        "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1000, "poisson_ratio": 0, "density": 1}},
        "bodies": [{"name": "line", "material": "m", "particles_per_cell_axis": 1, "frozen": true, "geometry":
          {"type": "box", "lower": [0, 0], "upper": [)J" +
                               std::to_string(cells) + R"J(, 1]}, "velocity": ["1e-6*sin(2*pi*x/L)", 0]}],
        "damping": {"viscous": 3}, "solver": {"stress_update": "first", "time_step": 0.01, "end_time": 1}})J";
      Scene scene(text);
      std::vector<double> v;
      for (int k = 0; k < 40; ++k) {
        scene.simulation.step();
        v.push_back(scene.body().velocity[2 * (cells / 4)] * 1e6);
      }
      // Cayley-Hamilton: v(k+1) - trace v(k) + determinant v(k-1) = 0, for two k together.
      const std::size_t a = 5, b = 20;
      const double det = (v[b + 1] * v[a] - v[a + 1] * v[b]) / (v[a - 1] * v[b] - v[b - 1] * v[a]);
      const double half = std::numbers::pi / cells, seen = std::cos(half) * std::cos(half);
      INFO(backend << " " << cells << " cells");
      CHECK(det == Approx(1 - seen * (1 - std::exp(-c * dt))).epsilon(1e-6));
      CHECK(det == Approx(std::exp(-c * dt)).epsilon(2.5 * (1 - seen) * c * dt));
    }
}

// The column of tests/verification/compaction.cpp: exact Cauchy stress -density g (l0 - Y), whatever the material. Local
// damping brings it to rest under its full weight at once, and leaves the weight on the floor.
TEST_CASE("a column comes to rest at its static settlement by local damping", "[damping]") {
  const double density = 80, gravity = 10, height = 50, modulus = 1e6;
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"flip", "apic"}) {
      const std::string text = R"J({"dimension": 2, "grid": {"cell_size": 2.5, "domain": [[0, 0], [2.5, 52.5]],
        "boundaries": {"all": "slip"}}, "shape": {"type": "gimp"}, "transfer": {"type": ")J" +
                               transfer + R"J("}, "backend": ")J" + backend + R"J(",
        "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 80}},
        "bodies": [{"name": "column", "material": "m",
                    "geometry": {"type": "box", "lower": [0, 0], "upper": [2.5, 50]}}],
        "gravity": [0, -10], "damping": {"local": 0.7}, "output": {"reactions": ["y_min"]},
        "solver": {"time_step": 0.006, "end_time": 12}})J";
      Scene scene(text);
      const BodyState start = scene.body();
      const Totals end = scene.run();
      const BodyState settled = scene.body();
      const auto stretch_at = [&](double Y) {
        const double s = -density * gravity * (height - Y) / modulus;  // mu (l - 1 / l) at nu = 0
        return s + std::sqrt(s * s + 1);
      };
      const std::size_t top = start.position.size() / 2 - 1;
      double exact = 0;
      const double Y = start.position[2 * top + 1];
      for (int k = 0; k < 1000; ++k) exact += stretch_at((k + 0.5) * Y / 1000) * Y / 1000;
      const double settlement = Y - exact, weight = density * gravity * height * 2.5;
      INFO(backend << " " << transfer << ": settles " << Y - settled.position[2 * top + 1] << " m of " << settlement);
      CHECK(end.kinetic < 1e-8 * weight * settlement);
      CHECK(settled.position[2 * top + 1] == Approx(exact).margin(0.01 * settlement));
      CHECK(scene.simulation.backend().reactions()[support_of_wall(1, 0)].force[1] == Approx(weight).epsilon(1e-3));
    }
}
