// Axial vibration of a fixed-free bar, small strain, 13 cells, one particle a cell. And the ledger on it: the residual
// of time integration shrinks with the step at first order.

#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* bar = R"J({
  "title": "bar", "dimension": 2, "precision": "double", "backend": "cpu",
  "constants": {"L": 25, "v": 0.1, "mode": 1},
  "grid": {"cell_size": 1.9230769230769231, "domain": [[0, 0], [38.461538461538462, 1.9230769230769231]],
           "boundaries": {"x_min": "slip", "x_max": "free", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 100, "poisson_ratio": 0, "density": 1}},
  "bodies": [{"name": "bar", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [25, 1.9230769230769231]}, "particles_per_cell_axis": 1,
              "velocity": ["v*sin((2*mode-1)*pi*x/(2*L))", 0]}],
  "solver": {"stress_update": "modified_last", "time_step": 0.019230769230769231, "end_time": 100}})J";

constexpr double height = 25.0 / 13;

/// Times at which the centre of mass turns (velocity changes sign), by linear interpolation.
std::vector<double> turning_times(Scene& scene, double& largest_energy_error) {
  std::vector<double> times;
  double previous = scene.metrics.initial().momentum[0];
  const double energy = scene.metrics.initial().total_energy();
  largest_energy_error = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    const Totals now = scene.metrics.measure();
    largest_energy_error = larger(largest_energy_error, std::abs(now.total_energy() / energy - 1));
    if (previous * now.momentum[0] < 0)
      times.push_back(now.time - now.time_step * now.momentum[0] / (now.momentum[0] - previous));
    previous = now.momentum[0];
  }
  return times;
}

}  // namespace

TEST_CASE("bar vibration: period and energy", "[bar]") {
  for (const int mode : {1, 2}) {
    INFO("mode " << mode);
    // The first mode has 13 cells; as many a wave length need 39 for the second, and 26 are within the band.
    Scene scene(bar, {set("/constants/mode", std::to_string(mode)), set("/grid/cell_size", digits(height / mode)),
                      set("/solver/time_step", digits(0.01 * height / mode))});
    CHECK(scene.metrics.initial().total_energy() / height ==
          Approx(0.0625).epsilon(1e-9));  // rho L v0^2 / 4: midpoints are exact
    double energy_error = 0;
    const auto times = turning_times(scene, energy_error);
    const double omega = (2 * mode - 1) * std::numbers::pi / 50 * 10;
    REQUIRE(times.size() > 10);
    const double half_period = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    CHECK(half_period == Approx(std::numbers::pi / omega).epsilon(0.01));
    CHECK(energy_error < 0.01);
  }
}

TEST_CASE("bar vibration: velocity of the centre of mass", "[bar]") {
  Scene scene(bar, {set("/solver/end_time", "10")});
  const double mass = scene.metrics.initial().mass;
  CHECK(scene.metrics.initial().momentum[0] / mass ==
        Approx(0.0636619772).epsilon(0.002));  // midpoint rule on 13 cells
  const Totals end = scene.run();
  CHECK(end.momentum[0] / mass == Approx(0.0636619772 * std::cos(0.6283185307 * end.time)).epsilon(0.01));
}

namespace {

/// The order in dt of the ledger's largest residual. The motion is smooth, without crossings and well resolved, of a
/// hyperelastic body (small-strain elasticity has no energy whose derivative is its stress): what is left is time
/// integration alone.
double order_of_residual(const std::string& backend, const std::string& shape, const std::string& update,
                         const std::string& speed) {
  const std::vector<double> steps{0.02, 0.01, 0.005};
  std::vector<double> residuals;
  for (const double step : steps) {
    Scene scene(
        bar, {set("/backend", backend), set("/solver/stress_update", update), set("/materials/m/type", "neo_hookean"),
              set("/shape/type", shape), set("/bodies/0/particles_per_cell_axis", "2"), set("/constants/v", speed),
              set("/solver/time_step", digits(step)), set("/solver/end_time", "4")});
    residuals.push_back(0);  // the run's largest: at single times it passes through zero
    while (!scene.simulation.finished()) {
      scene.simulation.step();
      residuals.back() = larger(residuals.back(), std::abs(scene.metrics.ledger_residual(scene.metrics.measure())));
    }
    CHECK(residuals.back() < 0.01 * scene.metrics.initial().total_energy());
  }
  INFO(residuals[0] << " " << residuals[1] << " " << residuals[2]);
  return observed_order(steps, residuals);
}

}  // namespace

TEST_CASE("the ledger's residual shrinks with the step at first order, with USAVG at second", "[ledger]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"linear", "bspline_quadratic"}) {
      INFO(backend << " " << shape);
      for (const std::string update : {"last", "first", "modified_last"})
        CHECK(std::abs(order_of_residual(backend, shape, update, "0.1") - 1) < 0.1);
      // USAVG's stress lies between the two halves of its strain: the work of its forces, dt f (v- + v+) / 2, misses
      // the change of the stored energy by O(dt^3) a step. At large strain F <- (I + dt L) F adds O(dt^2) a step with
      // the cube of the amplitude, so the wave is small here.
      CHECK(std::abs(order_of_residual(backend, shape, "averaged", "0.001") - 2) < 0.1);
      CHECK(std::abs(order_of_residual(backend, shape, "first", "0.001") - 1) < 0.1);
    }
}
