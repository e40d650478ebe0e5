// One particle without neighbours on linear shapes. Its stable step vanishes as it nears a node: C <= sqrt(2 f (1 -
// f)), f its place in the cell.

#include <cstdio>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The experiment. The particle stands at `f` of the middle cell of a strip. Until `restore` an end of its cell is
/// dragged, which strains it; then it is alone.
std::string text(const std::string& shape, const std::string& transfer, const std::string& update, double time_step,
                 bool dragged, const std::string& backend) {
  return R"({"dimension": 2, "backend": ")" + backend +
         R"(", "grid": {"cell_size": 1, "domain": [[0, 0], [9, 1]],
      "boundaries": {"x_min": "free", "x_max": "free", "y_min": "slip", "y_max": "slip"}},)" +
         std::string(
             dragged
                 ? R"("node_conditions": [{"type": "prescribed", "lower": [0, 0], "upper": [4, 1], "velocity": [1e-7, null]}],)"
                 : "") +
         R"("shape": {"type": ")" + shape + R"("}, "transfer": {"type": ")" + transfer + R"("},
      "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1, "poisson_ratio": 0, "density": 1}},
      "bodies": [{"name": "particle", "material": "m", "particles_per_cell_axis": 1,
                  "geometry": {"type": "box", "lower": [4, 0], "upper": [5, 1]}}],
      "solver": {"stress_update": ")" +
         update + R"(", "time_step": )" + digits(time_step) + R"(, "end_time": 1e9},
      "output": {"ledger": false}})";
}

BackendFactory placed_at(double f) {
  return [f](const Experiment& e, const Plan& p, std::vector<SeededBody> bodies) {
    SeedArrays seeds = bodies[0].arrays();
    seeds.position[0] = 4 + f;
    bodies[0].replace(std::move(seeds));
    return backend_factory(1)(e, p, std::move(bodies));
  };
}

/// The largest strain after `steps` free steps, over that at their start.
double growth(const std::string& shape, const std::string& transfer, const std::string& update, double f,
              double courant, int steps, const std::string& backend = "reference") {
  const Experiment dragged = experiment_from(text(shape, transfer, update, courant, true, backend)),
                   alone = experiment_from(text(shape, transfer, update, courant, false, backend));
  Simulation first(dragged, placed_at(f)), second(alone, placed_at(f));
  first.step();
  ArchiveWriter writer;
  first.save(writer);
  ArchiveReader reader(writer.bytes());
  second.restore(reader);
  const auto strain = [&] {
    const double F = second.backend().body_state(0).material_state.at("deformation_gradient")[0];
    return std::abs(F - 1);
  };
  const double before = strain();
  REQUIRE(before > 1e-9);
  try {
    for (int k = 0; k < steps; ++k) second.step();
  } catch (const RunFailure&) {
    return INFINITY;
  }
  return strain() / before;
}

}  // namespace

TEST_CASE("a lone particle is stable to sqrt(2 f (1 - f)) of a Courant number of one, and no further",
          "[lone_particle]") {
  std::printf(
      "Lone particle: place in the cell, limit of C, growth of the strain in 400 steps at 0.98 and 1.02 of it\n");
  for (const std::string backend : {"reference", "cpu"})
    for (const double f : {0.5, 0.2, 0.05, 0.95}) {
      const double limit = std::sqrt(2 * f * (1 - f));
      for (const char* transfer : {"pic", "flip"}) {
        INFO(backend << " " << transfer << " at " << f << ", limit " << limit);
        const double below = growth("linear", transfer, "last", f, 0.98 * limit, 400, backend);
        const double above = growth("linear", transfer, "last", f, 1.02 * limit, 400, backend);
        std::printf("  %-9s %-4s %.2f %.4f  %.1e %.1e\n", backend.c_str(), transfer, f, limit, below, above);
        CHECK(below <= 1.001);
        CHECK(above > 1e3);
      }
    }
}

TEST_CASE("a lone particle under MUSL is inert", "[lone_particle]") {
  for (const double f : {0.5, 0.05})
    CHECK(growth("linear", "pic", "modified_last", f, 0.9, 400) == Approx(1.0).epsilon(1e-9));
}
