// Coulomb friction on an incline, the slope aligned with the grid (gravity is turned instead). The block spans a
// periodic domain: its corners, where averaged volume gradients tilt the normal and drag (docs/method.md), are not this
// case.

#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* incline = R"J({
  "title": "block on an incline", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.05, "domain": [[0, 0], [0.5, 1]], "boundaries": {"x_min":"periodic","x_max":"periodic", "y_min": "stick","y_max":"free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "pic"},
  "contact": {"type": "coulomb", "friction": 0.5},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "ground", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.5, 0.2]}},
    {"name": "block", "material": "m", "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.5, 0.4]}}],
  "gravity": [4.905, -8.495709211],
  "solver": {"time_step": "auto", "courant": 0.3, "end_time": 0.6}, "output": {"ledger": true}})J";

double acceleration(const std::string& friction, const std::string& backend, double end_time) {
  Scene scene(incline, {set("/contact/friction", friction), set("/backend", backend),
                        set("/solver/end_time", digits(end_time))});
  const Totals end = scene.run();
  return end.momentum[0] / (0.5 * scene.metrics.initial().mass) / end.time;  // the ground is the other half, and held
}

}  // namespace

TEST_CASE("a block on an incline slides with g (sin - mu cos), or stays", "[friction]") {
  const double g = 9.81, sine = 0.5, cosine = std::sqrt(3) / 2;
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    CHECK(acceleration("0", backend, 0.6) == Approx(g * sine).epsilon(0.005));
    CHECK(acceleration("0.15", backend, 0.6) == Approx(g * (sine - 0.15 * cosine)).epsilon(0.005));
    CHECK(std::abs(acceleration("0.6", backend, 0.6)) < 0.005 * g * sine);
  }
}

TEST_CASE("a block on an incline close to sticking: the shear vibration of the sudden start fades", "[friction]") {
  Scene scene(incline, {set("/contact/friction", "0.5"), set("/solver/end_time", "1.2")});
  double middle = 0, middle_time = 0;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (middle_time > 0 || scene.simulation.time() < 0.4) continue;
    middle = scene.metrics.measure().momentum[0];
    middle_time = scene.simulation.time();
  }
  const Totals end = scene.metrics.measure();
  const double late = (end.momentum[0] - middle) / (0.5 * end.mass) / (end.time - middle_time);
  CHECK(late == Approx(0.65714539).epsilon(0.02));
}
