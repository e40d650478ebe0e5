// Two colliding elastic discs (Sulsky, Chen & Schreyer 1994): conservation, symmetry, no gain of energy. How much PIC
// loses and FLIP keeps is in tests/regression/colliding_discs.cpp.

#include <cmath>

#include "head_on_discs.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The upper disc is moved perpendicular to the velocity by b = 0.1, with a contact law, in free space.
const char* oblique = R"J({
  "title": "oblique discs", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.025, "domain": [[-0.1, -0.1], [1.1, 1.1]], "boundaries": {"all": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "contact": {"type": "coulomb", "friction": 0.3},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "lower", "material": "m", "geometry": {"type": "ball", "centre": [0.2, 0.2], "radius": 0.2}, "velocity": [0.1, 0.1]},
    {"name": "upper", "material": "m", "geometry": {"type": "ball", "centre": [0.729289322, 0.870710678], "radius": 0.2}, "velocity": [-0.1, -0.1]}],
  "solver": {"time_step": 0.001, "end_time": 3}})J";

}  // namespace

TEST_CASE("two discs: before the discs meet nothing is lost", "[discs]") {
  for (const std::string transfer : {"pic", "flip", "apic", "mls"}) {
    Scene scene = head_on_discs({set("/transfer/type", transfer), set("/solver/end_time", "1.3")});
    const Totals start = scene.metrics.initial(), end = scene.run();
    INFO(transfer);
    CHECK(start.mass == Approx(2 * 125.6637).epsilon(0.01));
    CHECK(start.kinetic == Approx(2.51327412).epsilon(0.01));
    CHECK(end.kinetic == Approx(start.kinetic).epsilon(1e-12));
    CHECK(std::abs(end.strain) < 1e-12 * start.kinetic);
  }
}

TEST_CASE("two discs: collision conserves momentum and symmetry and never gains energy", "[discs][energy_gain]") {
  for (const std::string transfer : {"pic", "flip", "apic", "mls"})
    for (const std::string shape : {"linear", "bspline_quadratic"}) {
      INFO(transfer << " " << shape);
      Scene scene = head_on_discs({set("/transfer/type", transfer), set("/shape/type", shape)});
      const Totals start = scene.metrics.initial();
      const double closing = approach_of(scene).rate;
      double largest = 0, nearest = 1;
      Totals now;
      while (!scene.simulation.finished()) {
        scene.simulation.step();
        if (scene.simulation.steps() % 50 != 0) continue;
        now = scene.metrics.measure();
        largest = larger(largest, now.total_energy());
        nearest = smaller(nearest, approach_of(scene).distance);
      }
      CHECK(largest <= 1.01 * start.total_energy());
      CHECK(std::hypot(now.momentum[0], now.momentum[1]) < 1e-10 * start.mass * 0.14);
      // The point reflection of the lower disc is the upper one, particle by particle in reverse order.
      const BodyState lower = scene.body(0), upper = scene.body(1);
      double skew = 0;
      for (std::size_t k = 0; k < lower.position.size(); k += 2)
        for (int c = 0; c < 2; ++c)
          skew = larger(skew, std::abs(lower.position[k + c] + upper.position[upper.position.size() - 2 - k + c] - 1));
      CHECK(skew < (shape == "linear" ? 1e-4 : 1e-6));  // crossings amplify rounding
      // The discs have met: two radii of 0.2 m no longer fit between their centres. And they separate again, with no
      // more of their speed than the energy at the end allows.
      const Approach end = approach_of(scene);
      CHECK(closing == Approx(-0.2828427125).epsilon(1e-9));
      CHECK(nearest < 0.39);
      CHECK(end.distance > nearest + 0.01);
      CHECK(end.rate > 0);
      CHECK(std::pow(end.rate / closing, 2) <= now.kinetic / start.kinetic * (1 + 1e-9));
    }
}

TEST_CASE("oblique collision keeps angular momentum, with and without friction", "[discs]") {
  for (const std::string friction : {"0", "0.3"})
    for (const std::string transfer : {"apic", "mls"}) {
      Scene scene(oblique, {set("/contact/friction", friction), set("/transfer/type", transfer)});
      const Totals start = scene.metrics.initial(), end = scene.run();
      INFO("friction " << friction << " " << transfer);
      CHECK(std::abs(start.angular_momentum[2]) == Approx(1.77715318).epsilon(0.02));
      CHECK(end.angular_momentum[2] == Approx(start.angular_momentum[2]).epsilon(0.005));
      CHECK(std::hypot(end.momentum[0] - start.momentum[0], end.momentum[1] - start.momentum[1]) <
            1e-11 * start.mass * 0.14);
      CHECK(end.total_energy() <= 1.001 * start.total_energy());
    }
}
