// Two colliding elastic discs (Sulsky, Chen & Schreyer 1994): conservation, symmetry, no gain of energy.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* discs = R"J({
  "title": "two discs", "dimension": 2, "precision": "double", "backend": "cpu",
  "grid": {"cell_size": 0.025, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "separate"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "lower", "material": "m", "geometry": {"type": "ball", "centre": [0.2, 0.2], "radius": 0.2}, "velocity": [0.1, 0.1]},
    {"name": "upper", "material": "m", "geometry": {"type": "ball", "centre": [0.8, 0.8], "radius": 0.2}, "velocity": [-0.1, -0.1]}],
  "solver": {"time_step": 0.001, "end_time": 3.5}})J";

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

/// The mean place and velocity of a body of equal particles.
struct Centre {
  double place[2] = {}, velocity[2] = {};
};

Centre centre_of(const BodyState& state) {
  Centre mean;
  const double count = static_cast<double>(state.position.size()) / 2;
  for (std::size_t k = 0; k < state.position.size(); ++k) {
    mean.place[k % 2] += state.position[k] / count;
    mean.velocity[k % 2] += state.velocity[k] / count;
  }
  return mean;
}

/// How far the centres of mass of two bodies are apart, m, and how fast that grows, m/s.
struct Approach {
  double distance = 0, rate = 0;
};

Approach approach_of(const Scene& scene) {
  const Centre a = centre_of(scene.body(0)), b = centre_of(scene.body(1));
  const double dx = b.place[0] - a.place[0], dy = b.place[1] - a.place[1], distance = std::hypot(dx, dy);
  return {distance, ((b.velocity[0] - a.velocity[0]) * dx + (b.velocity[1] - a.velocity[1]) * dy) / distance};
}

}  // namespace

TEST_CASE("two discs: before the discs meet nothing is lost", "[discs]") {
  for (const std::string transfer : {"pic", "flip", "apic", "mls"}) {
    Scene scene(discs, {set("/transfer/type", transfer), set("/solver/end_time", "1.3")});
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
      Scene scene(discs, {set("/transfer/type", transfer), set("/shape/type", shape)});
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
      if (transfer == "pic") {
        CHECK(now.total_energy() < 0.7 * start.total_energy());
      } else if (transfer == "flip") {
        CHECK(now.total_energy() > 0.9 * start.total_energy());
      }
      // The discs have met: two radii of 0.2 m no longer fit between their centres. And they separate again, with no
      // more of their speed than the energy at the end allows.
      const Approach end = approach_of(scene);
      CHECK(closing == Approx(-0.2828427125).epsilon(1e-9));
      CHECK(nearest < 0.39);
      CHECK(end.distance > nearest + 0.01);
      CHECK(end.rate > 0);
      CHECK(std::pow(end.rate / closing, 2) <= now.kinetic / start.kinetic * (1 + 1e-9));
      if (transfer == "flip") CHECK(end.rate > -0.8 * closing);
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
