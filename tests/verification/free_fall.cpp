// Rigid flight under gravity is exact for the discrete scheme, whatever shape, transfer and number of cells crossed.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* flight_2d = R"J({
  "title": "flight", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [8, 6]], "boundaries": {"all": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e3, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": [1, 3], "radius": 0.37}, "velocity": [8, 2]}],
  "gravity": [0, -9.81],
  "solver": {"time_step": 0.002, "end_time": 0.5}, "output": {"ledger": true},
  "compare": {"exact": {"type": "free_fall"}}})J";

const char* flight_3d = R"J({
  "title": "flight", "dimension": 3, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0, 0], [5, 2, 2]], "boundaries": {"all": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "von_mises", "youngs_modulus": 1e3, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 100}},
  "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": [1, 1, 1], "radius": 0.21}, "velocity": [10, 1, -0.3]}],
  "gravity": [0, -9.81, 1],
  "solver": {"time_step": 0.002, "end_time": 0.25}, "output": {"ledger": true},
  "compare": {"exact": {"type": "free_fall"}}})J";

void check_flight(const char* text, const std::vector<std::string>& overrides, double scale) {
  Scene scene(text, overrides);
  const Totals start = scene.metrics.initial(), end = scene.run();
  const double roundings = 1e-12;
  CHECK(end.position_error_max < roundings * scale);
  CHECK(end.velocity_error_max < roundings * scale);
  CHECK(std::abs(end.smallest_volume_ratio - 1) < roundings);
  CHECK(std::abs(end.largest_volume_ratio - 1) < roundings);
  for (int c = 0; c < scene.experiment.dimension; ++c)
    CHECK(std::abs(end.momentum[c] - start.momentum[c] - start.mass * scene.experiment.gravity[c] * end.time) <
          roundings * start.mass * scale);
  const Ledger& ledger = scene.simulation.backend().ledger();
  CHECK(std::abs(ledger.gravity - (end.kinetic - start.kinetic)) < 1e-11 * end.kinetic);
  CHECK(std::abs(ledger.internal_force) < 1e-10 * end.kinetic);
}

}  // namespace

TEST_CASE("free flight in 2-D crosses 40 cells exactly", "[free_flight]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic"})
      for (const std::string transfer : {"pic", "flip", "apic", "mls", "rpic", "aflip", "asflip"})
        for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
          if (backend == "reference" && order == "first")
            continue;  // the slow backend proves USL and MUSL; parity covers USF
          INFO(backend << " " << shape << " " << transfer << " " << order);
          check_flight(flight_2d,
                       {set("/backend", backend), set("/shape/type", shape), set("/transfer/type", transfer),
                        set("/solver/stress_update", order)},
                       10);
        }
}

TEST_CASE("free flight in 3-D crosses 25 cells exactly", "[free_flight]") {
  for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic"})
    for (const std::string transfer : {"pic", "flip", "apic", "mls", "rpic", "aflip", "asflip"}) {
      INFO(shape << " " << transfer);
      check_flight(flight_3d, {set("/backend", "cpu"), set("/shape/type", shape), set("/transfer/type", transfer)}, 10);
    }
}

// After n steps of dt a particle that falls from rest relative to v0 has x = x0 + v0 t + g t^2/2 by the mean of its
// velocities, the parabola itself, and x0 + v0 t + g t (t + dt)/2 by the new one.
TEST_CASE("filtered particles that move by their mean velocity follow the parabola", "[free_flight]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string precision : {"double", "float"})
      for (const std::string filter : {"fmpm", "xpic"})
        for (const std::string shape : {"bspline_quadratic", "cpdi2"})
          for (const std::string order : {"last", "modified_last", "averaged"})
            for (const bool mean : {false, true}) {
              if (backend == "reference" && precision == "float") continue;
              INFO(backend << " " << precision << " " << filter << " " << shape << " " << order << " " << mean);
              const std::string update = mean ? "mean_velocity" : "new_velocity";
              Scene scene(flight_2d, {set("/backend", backend), set("/precision", precision), set("/shape/type", shape),
                                      set("/transfer/type", "pic"), set("/solver/stress_update", order),
                                      set("/filter", R"({"type": ")" + filter +
                                                         R"(", "order": 2, "position_update": ")" + update + "\"}"),
                                      set("/compare", "null")});
              const std::vector<double> start = scene.body().position;
              scene.run_steps(100);
              const std::vector<double> end = scene.body().position;
              const double dt = 0.002, t = 100 * dt, g = -9.81, extra = mean ? 0 : 0.5 * g * t * dt;
              const double margin = precision == "float" ? 2e-5 : 1e-12;
              REQUIRE(start.size() > 40);
              double worst = 0;
              for (std::size_t k = 0; k < start.size(); k += 2) {
                worst = larger(worst, std::abs(end[k] - start[k] - 8 * t));
                worst = larger(worst, std::abs(end[k + 1] - start[k + 1] - 2 * t - 0.5 * g * t * t - extra));
              }
              CHECK(worst < margin);
            }
}
