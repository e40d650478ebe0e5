// Bodies that meet one that a grip holds: it gives way to nothing, as a rigid body does.

#include <cmath>

#include "metrics/chosen_numbers.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A column of 0.4 by 0.6 m, 240 kg a metre, that a force of 24 kN a metre presses onto a plate, all of which is in a grip.
/// The force grows over 0.1 s and the motion is damped, so that it ends at rest.
std::string pressed_column(double cell_size, const std::string& held) {
  return R"J({"dimension": 2, "grid": {"cell_size": )J" + digits(cell_size) +
         R"J(, "domain": [[0, 0], [0.4, 1.2]], "boundaries": {"all": "slip"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "contact": {"type": "coulomb", "friction": 0},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 1000}},
    "bodies": [{"name": "plate", "material": "m", "geometry": {"type": "box", "lower": [0, 0.2], "upper": [0.4, 0.4]}},
               {"name": "column", "material": "m", "geometry": {"type": "box", "lower": [0, 0.4], "upper": [0.4, 1]}}],
    "grips": [{"name": "all", "body": "plate", "where": {"type": "box", "lower": [0, 0], "upper": [0.4, 0.4]},
               "velocity": )J" +
         held + R"J(}], "body_force": [0, "-100*min(t/0.1, 1)*(Y > 0.4)"], "damping": {"viscous": 40},
    "solver": {"end_time": 0.4}, "output": {"reactions": true}})J";
}

/// A plate that a grip holds, and a slab of 400 kg a metre that weight presses onto it and that slides on it at 1 m/s. The
/// weight grows over 0.05 s.
std::string sliding_on_a_plate(double friction) {
  return R"J({"dimension": 2, "grid": {"cell_size": 0.05, "domain": [[0, 0], [2, 1]],
                                      "boundaries": {"all": "free", "x_min": "periodic", "x_max": "periodic"}},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "gravity": [0, "-10*min(t/0.05, 1)"],
    "contact": {"type": "coulomb", "friction": )J" +
         digits(friction) + R"J(},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 1000}},
    "bodies": [{"name": "plate", "material": "m", "geometry": {"type": "box", "lower": [0, 0.2], "upper": [2, 0.4]}},
               {"name": "slab", "material": "m", "velocity": [1, 0],
                "geometry": {"type": "box", "lower": [0, 0.4], "upper": [2, 0.6]}}],
    "grips": [{"name": "all", "body": "plate", "where": {"type": "box", "lower": [0, 0], "upper": [2, 0.4]},
               "velocity": [0, 0]}],
    "solver": {"end_time": 0.15}, "output": {"bodies": true}})J";
}

double speed(const Scene& scene, int body) {
  const BodyState state = scene.body(body);
  double sum = 0;
  for (std::size_t i = 0; i < state.velocity.size(); i += 2) sum += state.velocity[i];
  return 2 * sum / static_cast<double>(state.velocity.size());
}

}  // namespace

TEST_CASE("a column rests on a gripped plate by its weight, whatever the step", "[grips][contact]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"pic", "flip", "apic", "mls"})
      for (const double courant : {0.4, 0.1}) {
        if (courant < 0.4 && (backend == "reference" || transfer != "apic")) continue;
        if (backend == "reference" && transfer != "flip") continue;
        INFO(backend << " " << transfer << " courant " << courant);
        Scene scene(pressed_column(0.05, "[0, 0]"), {set("/backend", backend), set("/transfer/type", transfer),
                                                     set("/solver/courant", digits(courant))});
        scene.run();
        const ContactRecord& contact = scene.simulation.backend().contact_record();
        CHECK(contact.largest_penetration < 0.02 * 0.05);
        CHECK(-contact.force[1] == Approx(24000).epsilon(2e-3));
        CHECK(scene.simulation.backend().reactions().back().force[1] == Approx(24000).epsilon(2e-3));
      }
}

TEST_CASE("friction brakes a slab on a gripped plate with mu g, and holds it where it is high enough",
          "[grips][contact]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"pic", "flip", "apic"}) {
      if (backend == "reference" && transfer != "apic") continue;
      INFO(backend << " " << transfer);
      const std::vector<std::string> overrides{set("/backend", backend), set("/transfer/type", transfer)};
      Scene slides(sliding_on_a_plate(0.2), overrides), sticks(sliding_on_a_plate(20), overrides);
      slides.run();
      // mu g acts through 0.05/2 + 0.1 s.
      CHECK(speed(slides, 1) == Approx(1 - 0.2 * 10 * 0.125).epsilon(0.01));
      if (transfer == "flip") continue;  // it keeps the swing that the sudden stop of the slab's foot leaves
      sticks.run();
      CHECK(std::abs(speed(sticks, 1)) < 0.02);
    }
}

TEST_CASE("the ledger of a gripped plate that pushes a column closes in first order", "[grips][contact]") {
  for (const std::string backend : {"reference", "cpu"}) {
    std::vector<double> residuals;
    for (const double courant : {0.2, 0.1, 0.05}) {
      INFO(backend << " courant " << courant);
      Scene scene(pressed_column(0.05, R"J([0, "0.5*min(t/0.05, 1)"])J"),
                  {set("/backend", backend), set("/solver/courant", digits(courant)), "/solver/end_time=0.1",
                   "/damping/viscous=0", "/transfer/type=flip"});
      const Totals end = scene.run();
      residuals.push_back(std::abs(scene.metrics.ledger_residual(end)) / end.strain);
    }
    CHECK(residuals[0] < 0.05);
    for (std::size_t i = 1; i < residuals.size(); ++i) CHECK(residuals[i] < 0.6 * residuals[i - 1]);
  }
}
