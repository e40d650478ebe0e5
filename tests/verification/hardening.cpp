// Metal that hardens, between walls: a homogeneous deformation has no waves, so that the force on a wall is that of the law at
// any speed. The closed forms belong to small strain; at strains of 1e-5 the law of finite strain differs by terms of
// that order, relative.

#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double young = 2600, poisson = 0.3, shear = young / (2 * (1 + poisson)),
                 bulk = young / (3 * (1 - 2 * poisson)), yield = 0.01, step = 0.05;

/// A square metre of metal between walls at y = 0 and y = 1 that move with it, and periodic along x. `velocity` is that of
/// body and walls, [2], m/s.
std::string slab(const std::string& velocity, double hardening, double end_time) {
  return R"J({"dimension": 2,
    "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {
      "x_min": "periodic", "x_max": "periodic", "y_min": {"type": "prescribed", "velocity": )J" +
         velocity + R"J(}, "y_max": {"type": "prescribed", "velocity": )J" + velocity + R"J(}}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
    "materials": {"m": {"type": "von_mises", "youngs_modulus": )J" +
         digits(young) + R"J(, "poisson_ratio": )J" + digits(poisson) + R"J(, "density": 1000, "yield_stress": )J" +
         digits(yield) + R"J(, "hardening_modulus": )J" + digits(hardening) + R"J(}},
    "bodies": [{"name": "b", "material": "m", "velocity": )J" +
         velocity + R"J(, "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 1]}}],
    "output": {"reactions": true}, "solver": {"time_step": )J" +
         digits(step) + R"J(, "end_time": )J" + digits(end_time) + "}}";
}

/// Runs to the end, and asks after each step what the upper wall gives along an axis: law(strain) is expected, N from a metre
/// of wall. `rate` is that of the strain, 1/s.
template <class Law>
void check_wall(Scene& scene, int axis, double rate, const Law& law) {
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    const double strain = rate * (scene.simulation.time() - step);  // the stress that acted
    const double force = scene.simulation.backend().reactions()[support_of_wall(1, 1)].force[axis];
    INFO("strain " << strain << ", force " << force << " N");
    CHECK(force == Approx(law(strain)).epsilon(3e-4).margin(1e-7));
  }
}

}  // namespace

TEST_CASE("a slab that is sheared beyond its yield stress hardens with G H / (3 G + H)", "[hardening]") {
  const double rate = 1e-6, yields_at = yield / (std::sqrt(3.0) * shear);
  for (const std::string backend : {"reference", "cpu"})
    for (const double hardening : {0.0, 650.0, 2600.0}) {
      INFO(backend << " H = " << hardening);
      const double slope = shear * hardening / (3 * shear + hardening);
      Scene scene(slab("[\"1e-6*y\", 0]", hardening, 20), {set("/backend", backend)});
      check_wall(scene, 0, rate, [&](double strain) {
        return shear * std::min(strain, yields_at) + slope * std::max(0.0, strain - yields_at);
      });
      const double plastic = (rate * 20 - yields_at) / std::sqrt(3.0) / (1 + hardening / (3 * shear));
      const BodyState state = scene.body();
      for (const double found : state.material_state.at("equivalent_plastic_strain"))
        CHECK(found == Approx(plastic).epsilon(3e-4));
    }
}

TEST_CASE("a slab that is pressed together beyond its yield stress hardens with K + 4 G / 3 H / (3 G + H)",
          "[hardening]") {
  // Uniaxial strain: |s| grows by 2 G of the strain less 3 G of the plastic strain, and yields at sy / (2 G).
  const double rate = -1e-6, yields_at = yield / (2 * shear);
  for (const std::string backend : {"reference", "cpu"})
    for (const double hardening : {0.0, 650.0, 2600.0}) {
      INFO(backend << " H = " << hardening);
      const auto plastic = [&](double strain) {
        return 2 * shear * std::max(0.0, std::abs(strain) - yields_at) / (3 * shear + hardening);
      };
      Scene scene(slab("[0, \"-1e-6*y\"]", hardening, 15), {set("/backend", backend)});
      check_wall(scene, 1, rate, [&](double strain) {
        const double sheared = std::min(2 * shear * std::abs(strain), yield + hardening * plastic(strain));
        return -(bulk * std::abs(strain) + 2.0 / 3.0 * sheared);
      });
      const BodyState state = scene.body();
      for (const double found : state.material_state.at("equivalent_plastic_strain"))
        CHECK(found == Approx(plastic(rate * 15)).epsilon(3e-4));
    }
}
