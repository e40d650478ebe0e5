// Values that colour particles: every attribute by name, components by suffix.

#include "metrics/particle_quantities.hpp"

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {
const char* shear = R"J({
  "title": "shear", "dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 2]], "boundaries": {"all": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0.5, 0.5], "upper": [1.5, 1.5]}, "velocity": ["0.2*y", 1]}],
  "solver": {"time_step": 0.001, "end_time": 0.01}, "output": {"colour_by": "displacement"}})J";
}  // namespace

TEST_CASE("attributes and their components colour particles", "[metrics]") {
  Scene scene(shear);
  scene.run();
  const BodyState state = scene.body();
  const auto value = [&](const char* name) { return quantity(scene.experiment, 0, state, name)[100]; };
  CHECK(value("velocity_y") == state.velocity[201]);
  CHECK(value("speed") == Approx(std::hypot(state.velocity[200], state.velocity[201])));
  CHECK(value("deformation_gradient_xy") == state.material_state.at("deformation_gradient")[401]);
  CHECK(value("deformation_gradient_xy") == Approx(0.002).epsilon(0.05));
  CHECK(value("affine_velocity_xy") == Approx(0.2).epsilon(0.05));
  CHECK(value("displacement") == Approx(std::hypot(0.01, 0.2 * 0.01 * state.position[201])).epsilon(0.05));
  const auto names = quantity_names(plugins());
  for (const char* name :
       {"velocity_x", "deformation_gradient_zz", "equivalent_plastic_strain", "elastic_left_cauchy_green_xy"})
    CHECK(std::count(names.begin(), names.end(), name) == 1);
}

TEST_CASE("melted particles are measured with the parameters of the melt", "[metrics]") {
  const std::string warm =
      R"J({"dimension": 2, "backend": "reference", "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 2, "thermal": {
      "conductivity": 1, "heat_capacity": 10, "phase_change": {"temperature": 300, "latent_heat": 7,
      "melted": {"youngs_modulus": 10, "heat_capacity": 30}}}}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 1]},
                "temperature": "290 + 20*x", "velocity": ["x", 0]}],
    "solver": {"time_step": 1e-4, "end_time": 1}, "output": {"colour_by": "melted_fraction"}})J";
  Scene scene(warm);
  const Totals start = scene.metrics.measure();
  // Half of two kilograms has melted: 10 K below and above, 5 K in the mean.
  CHECK(start.heat_content == Approx(1 * 10 * -5 + 1 * 30 * 5));
  CHECK(start.latent_heat == Approx(1 * 7));
  CHECK(start.lowest_temperature == Approx(290.5));
  CHECK(start.highest_temperature == Approx(309.5));
  scene.run_steps(50);
  const BodyState state = scene.body();
  CHECK(quantity(scene.experiment, 0, state, "temperature") == state.host_state.at("temperature"));
  const auto melted = quantity(scene.experiment, 0, state, "melted_fraction");
  const auto energy = quantity(scene.experiment, 0, state, "stored_energy");
  const auto ratio = quantity(scene.experiment, 0, state, "volume_ratio");
  for (const std::size_t p : {3 + 20 * 10, 16 + 20 * 10}) {  // in a row along x, of the same stretch
    CAPTURE(p);
    CHECK(melted[p] == (p % 20 < 10 ? 0 : 1));
    // Energy of a stretch J along x, both Lame parameters proportional to Young's modulus.
    const double E = p % 20 < 10 ? 1000 : 10, J = ratio[p], mu = E / 2.6, lambda = E * 0.3 / (1.3 * 0.4);
    CHECK(energy[p] == Approx(mu / 2 * (J * J - 1) - mu * std::log(J) + lambda / 2 * std::pow(std::log(J), 2)));
  }
}

TEST_CASE("an extreme of values of which one is not a number is not a number", "[metrics]") {
  Scene scene(
      R"J({"dimension": 2, "backend": "reference", "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
    "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 2,
                        "thermal": {"conductivity": 1, "heat_capacity": 10}}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 1]},
                "temperature": "sqrt(x - 0.5)", "velocity": ["sqrt(x - 0.5)", 0]}],
    "solver": {"time_step": 1e-4, "end_time": 1}})J");
  const Totals totals = scene.metrics.measure();
  for (const double extreme : {totals.lowest_temperature, totals.highest_temperature, totals.largest_speed})
    CHECK(std::isnan(extreme));
  CHECK(totals.largest_volume_ratio == 1);
}
