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
