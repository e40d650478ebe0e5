// What the reference backend says of its own memory, and of what it was not told to hold or do.

#include "backends/reference/reference_backend.hpp"
#include "simulation/seeding.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A box of 3 x 2 cells with `per_axis` particles along each axis of a cell, in a domain of 5 x 4 cells.
std::string box_of(int dimension, int per_axis) {
  const bool flat = dimension == 2;
  return R"({"title": "box", "dimension": )" + std::to_string(dimension) +
         R"(, "grid": {"cell_size": 0.5, "domain": )" + (flat ? "[[0, 0], [2.5, 2]]" : "[[0, 0, 0], [2.5, 2, 1.5]]") +
         R"(, "boundaries": {"all": "slip"}}, "shape": {"type": "linear"}, "transfer": {"type": "pic"}, "materials":
    {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0.3, "density": 1}},
    "bodies": [{"name": "b", "material": "m", "particles_per_cell_axis": )" +
         std::to_string(per_axis) + R"(, "geometry": {"type": "box", "lower": )" +
         (flat ? "[0.5, 0.5], \"upper\": [2, 1.5]}}]" : "[0.5, 0.5, 0.5], \"upper\": [2, 1.5, 1]}}]") +
         R"(, "solver": {"time_step": 0.01, "end_time": 1}, "output": {"ledger": false}})";
}

}  // namespace

TEST_CASE("the reference backend names what its plan lacks", "[reference]") {
  reference::ScalarField heat("heat");
  CHECK_THROWS_WITH(heat[0], R"(the plan has no field "heat" of the nodes)");
  CHECK_THROWS_WITH(std::as_const(heat)[0], R"(the plan has no field "heat" of the nodes)");
  const Experiment experiment = experiment_from(box_of(2, 1), {"/backend=reference"});
  const Plan plan = make_plan(experiment);
  const std::vector<SeededBody> seeded{seed_body(experiment, 0)};
  const reference::Particles body(experiment, plan, 0, seeded[0]);
  CHECK_THROWS_WITH(body.values("temperature"), R"(the plan has no field "temperature" of the particles)");
  CHECK_THROWS_WITH(body.values("position", Origin::material), R"(the plan has no field "position" of the particles)");
  CHECK(body.values("position").rows() == 2);
}

TEST_CASE("the reference backend refuses a pass that begins with what shares another's visit", "[reference]") {
  const Experiment experiment = experiment_from(box_of(2, 1), {"/backend=reference"});
  const Plan plan = make_plan(experiment);
  reference::ReferenceBackend backend(experiment, plan, {seed_body(experiment, 0)});
  Pass pass;
  Operator operation;
  operation.act = Act::keep_velocity;
  pass.add(operation);
  CHECK_THROWS_WITH(backend.execute(pass, {}), "the reference backend does not execute pass \"" + pass.name() + "\"");
}

// Beside the plan's fields a particle has b, A, the stress (four numbers in 2-D, six in 3-D), the volume ratio, five
// vectors and matrices of what was gathered and the velocity gradient, in whole packs of particles.
TEST_CASE("the bytes of the reference backend are those of its arrays", "[reference]") {
  for (const int D : {2, 3})
    for (const int per_axis : {1, 2}) {
      INFO(D << "-D with " << per_axis << " particles along an axis");
      const Scene scene(box_of(D, per_axis), {"/backend=reference"});
      const std::size_t count = 6u * (per_axis == 1 ? 1u : D == 2 ? 4u : 8u);
      REQUIRE(scene.simulation.particle_count() == count);
      std::size_t of_particle = 3 * D + 4 * D * D + (D == 2 ? 4 : 6) + 1, of_node = 0;
      for (const Field& field : scene.simulation.plan().fields) {
        if (field.owner == Owner::particle) of_particle += static_cast<std::size_t>(field.components);
        if (field.owner == Owner::node) of_node += field.components == 1 ? 1 : 3;
      }
      const std::size_t packs = (count + MPM_LANES - 1) / MPM_LANES;
      CHECK(scene.simulation.backend().particle_bytes() == packs * MPM_LANES * of_particle * sizeof(double));
      const std::size_t nodes = D == 2 ? 12 * 11 : 12 * 11 * 10;  // of 5, 4 and 3 cells, and three beyond each wall
      CHECK(scene.simulation.backend().grid_bytes() == nodes * of_node * sizeof(double));
    }
}
