// The section "artificial_viscosity" of a material: what it adds to a plan, its defaults, and what is refused by name.

#include <algorithm>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* const block = R"J({
  "dimension": 2,
  "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "materials": {"a": {"type": "neo_hookean", "density": 1000, "youngs_modulus": 1e4, "poisson_ratio": 0.2},
                "b": {"type": "neo_hookean", "density": 1000, "youngs_modulus": 1e4, "poisson_ratio": 0.2}},
  "bodies": [{"name": "p", "material": "a", "geometry": {"type": "box", "lower": [0.25, 0.25], "upper": [0.5, 0.75]}},
             {"name": "q", "material": "b", "geometry": {"type": "box", "lower": [0.5, 0.25], "upper": [0.75, 0.75]}}],
  "solver": {"time_step": 0.01, "end_time": 1}
})J";

const std::string at = "/materials/a/artificial_viscosity";

void check_refused(const std::vector<std::string>& overrides, const std::string& message) {
  CHECK_THROWS_WITH(experiment_from(block, overrides), ContainsSubstring(message));
}

}  // namespace

TEST_CASE("only bodies of a material with artificial viscosity have a field for it", "[plan][viscosity]") {
  for (const std::string backend : {"reference", "cpu"}) {
    const Plan none = make_plan(experiment_from(block, {set("/backend", backend)}));
    const Plan some = make_plan(experiment_from(block, {set("/backend", backend), at + "={}"}));
    CHECK(none.particle_field(0, "artificial_pressure") == nullptr);
    const Field* const field = some.particle_field(0, "artificial_pressure");
    REQUIRE(field != nullptr);
    CHECK(field->because.find(at) == 0);
    CHECK(some.particle_field(1, "artificial_pressure") == nullptr);
    CHECK(some.bytes_per_particle(0) == none.bytes_per_particle(0) + sizeof(double));
    CHECK(some.bytes_per_particle(1) == none.bytes_per_particle(1));
    CHECK(some.bytes_per_node() == none.bytes_per_node());
    CHECK(some.fused() == none.fused());
  }
}

TEST_CASE("the coefficients of artificial viscosity are 0.2 and 2 unless a file says others", "[viscosity]") {
  const Experiment standard = experiment_from(block, {at + "={}"});
  REQUIRE(standard.materials[0].artificial_viscosity);
  CHECK(standard.materials[0].artificial_viscosity->linear == 0.2);
  CHECK(standard.materials[0].artificial_viscosity->quadratic == 2);
  CHECK(!standard.materials[1].artificial_viscosity);
  CHECK(standard.resolved["materials"]["a"]["artificial_viscosity"] ==
        nlohmann::ordered_json{{"linear", 0.2}, {"quadratic", 2.0}});
  CHECK(!standard.resolved["materials"]["b"].contains("artificial_viscosity"));
  const Experiment given = experiment_from(block, {at + R"(={"linear": 1, "quadratic": 0})"});
  CHECK(given.materials[0].artificial_viscosity->linear == 1);
  CHECK(given.materials[0].artificial_viscosity->quadratic == 0);
}

TEST_CASE("artificial viscosity is refused where it makes no sense, by name", "[viscosity]") {
  check_refused({at + R"(={"linear": -0.1})"}, "/materials/a/artificial_viscosity/linear");
  check_refused({at + R"(={"quadratic": -1})"}, "/materials/a/artificial_viscosity/quadratic");
  check_refused({at + R"(={"cubic": 1})"}, "cubic");
  check_refused(
      {R"(/materials/a={"type": "ideal_gas", "pressure": 1, "density": 1, "artificial_viscosity": {}})"},
      R"(material "ideal_gas" has an artificial viscosity of its own, by its parameter "quadratic_viscosity"; )"
      R"(remove "artificial_viscosity")");
}

TEST_CASE("artificial viscosity is a name of particle data only where a material has it", "[viscosity]") {
  const std::string asks = R"(/output={"particles": {"fields": ["artificial_pressure"], "count": 2}})";
  check_refused({asks}, R"(no material of this scene has "artificial_viscosity")");
  CHECK_NOTHROW(experiment_from(block, {asks, at + "={}"}));
}
