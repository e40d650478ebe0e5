// Case A6: dissipation of FLIP by stress-update order, exact. A periodic line of one particle a cell; the amplitude of
// one mode follows q(n+2) = trace q(n+1) - det q(n), so four steps give the determinant of the scheme's amplification
// matrix.

#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr int cells = 32, mode = 2;
constexpr double courant = 0.5;

const char* line = R"J({
  "title": "periodic line", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 1, "domain": [[0, 0], [32, 1]], "boundaries": {"x_min": "periodic", "x_max": "periodic", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1, "poisson_ratio": 0, "density": 1}},
  "bodies": [{"name": "line", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [32, 1]}, "particles_per_cell_axis": 1,
              "velocity": ["1e-6*sin(2*pi*2*x/32)", 0]}],
  "solver": {"stress_update": "last", "time_step": 0.5, "end_time": 100}, "output": {"ledger": false}})J";

/// Amplitude of the mode in the particle velocities.
double amplitude(const Scene& scene) {
  const BodyState state = scene.body();
  double sum = 0;
  for (int p = 0; p < cells; ++p)
    sum += state.velocity[2 * p] * std::sin(2 * std::numbers::pi * mode * (p + 0.5) / cells);
  return 2 * sum / cells;
}

double measured_determinant(const std::string& backend, const std::string& order) {
  Scene scene(line, {set("/backend", backend), set("/solver/stress_update", order)});
  double q[4];
  for (double& value : q) {
    scene.run_steps(40);  // steps of 40: the recurrence holds for powers too, and the determinant becomes det^40
    value = amplitude(scene);
  }
  const double power = (q[1] * q[3] - q[2] * q[2]) / (q[0] * q[2] - q[1] * q[1]);
  return std::pow(power, 1.0 / 40);
}

}  // namespace

// USAVG on the grid's velocity u = S+ V and the scaled stress s of a mode, z the step times its frequency and s2 =
// |symbol of S|^2: s* = s + z u / 2;  u+ = u - z s*;  s' = s* + z u+ / 2;  u' = u - s2 z s* (FLIP). Its determinant, 1
// - z^2 (1 - s2) / 2, is the mean of those of USF (1) and USL (1 - z^2 (1 - s2)). With z = 2 C sin(theta/2) and 1 - s2
// = sin^2(theta/2) the amplitude's factor a step is 1 - C^2 theta^4 / 16 + O(theta^6): neutral to the third order in
// the wave number, and half of what USL takes beyond it. Its trace, 2 - z^2 (1 + s2) / 2, makes it stable to z^2 <= 4.

TEST_CASE("A6 USL dissipates, USF and MUSL do not, USAVG half of it", "[A][A6]") {
  const double theta = 2 * std::numbers::pi * mode / cells;
  const double s2 = std::pow(std::cos(theta / 2), 2), z = 2 * courant * std::sin(theta / 2);
  const double last = 1 - z * z * (1 - s2);
  REQUIRE(std::sqrt(last) == Approx(0.9992755).epsilon(1e-7));  // the published number of the case
  for (const char* backend : {"reference", "cpu"}) {
    INFO("backend " << backend);
    // Finite strain enters at the amplitude 1e-6, relative.
    CHECK(measured_determinant(backend, "last") == Approx(last).epsilon(1e-7));
    CHECK(measured_determinant(backend, "first") == Approx(1.0).epsilon(1e-7));
    CHECK(measured_determinant(backend, "modified_last") == Approx(1.0).epsilon(1e-7));
    CHECK(measured_determinant(backend, "averaged") == Approx(0.5 * (1 + last)).epsilon(1e-7));
  }
}
