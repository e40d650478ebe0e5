// Gravity that changes in time: each step takes that of its start, so a flight is the sum of these, to rounding.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* flight = R"J({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 3]],
    "boundaries": {"all": "free"}}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": [0.6, 2], "radius": 0.23},
              "velocity": [1, 0.5]}],
  "gravity": [0.4, "-9.81*min(t/0.1,1)"], "solver": {"time_step": 0.004, "end_time": 0.4}})J";

}  // namespace

TEST_CASE("a flight under gravity that grows is the sum of its steps", "[gravity]") {
  const double dt = 0.004;
  double v = 0.5, y = 0;
  for (int k = 0; k < 100; ++k) y += dt * (v += dt * -9.81 * std::min(k * dt / 0.1, 1.0));
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"flip", "apic", "mls"})
      for (const std::string order : {"last", "first", "modified_last", "averaged"})
        for (const std::string passes : {"auto", "separate"}) {
          INFO(backend << " " << transfer << " " << order << " " << passes);
          Scene scene(flight, {set("/backend", backend), set("/transfer/type", transfer), set("/solver/passes", passes),
                               set("/solver/stress_update", order)});
          const Totals start = scene.metrics.initial(), end = scene.run();
          REQUIRE(end.step == 100);
          CHECK(end.momentum[1] / end.mass == Approx(v).epsilon(1e-11));
          CHECK(end.momentum[0] / end.mass == Approx(1 + 0.4 * 0.4).epsilon(1e-11));
          CHECK(end.centre_of_mass[1] - start.centre_of_mass[1] == Approx(y).epsilon(1e-10));
          // It has no potential along y: its work is a cause of its own, and the books close.
          const Ledger& ledger = scene.simulation.ledger();
          CHECK(ledger.gravity_without_potential == Approx(0.5 * end.mass * (v * v - 0.25)).epsilon(1e-10));
          CHECK(end.gravitational == Approx(-0.4 * end.mass * end.centre_of_mass[0]).epsilon(1e-12));
          CHECK(std::abs(scene.metrics.ledger_residual(end)) < 0.5 * dt * 0.4 * 0.4 * 2 * end.mass);
        }
}

TEST_CASE("constant formulas of gravity are constants", "[gravity]") {
  const Experiment experiment = experiment_from(flight, {R"(/gravity=["0.2+0.2", "-9.81 m/s^2"])"});
  CHECK_FALSE(experiment.changing_gravity);
  CHECK(experiment.gravity == Vector3{0.4, -9.81, 0});
  CHECK(experiment.gravity_has_potential(1));
}

TEST_CASE("gravity that stops being a number stops the run with its place", "[gravity]") {
  Scene scene(flight, {R"J(/gravity=[0, "-1/(0.2-t)"])J", "/solver/time_step=0.05"});
  try {
    scene.run();
    FAIL("the run went on");
  } catch (const std::runtime_error& stopped) {
    CHECK(std::string(stopped.what())
              .find(": /gravity/1: is not a finite number at t = 0.2 s: \"-1/(0.2-t)\" at character 1 is -1 / 0") !=
          std::string::npos);
  }
}
