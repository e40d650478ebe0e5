// What the internal force of a node does as a stressed particle crosses a cell face. The gradient of the tent jumps
// there, by 1/h at the outer nodes and 2/h at the one that is crossed; those of all wider shapes do not. `ctest -V`
// shows the table.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "materials/linear_elastic/linear_elastic.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double dt = 1e-3, heavy = 1e3, stretch = 1.25;

/// A quarter of a cell that will be stretched, and three heavy particles that will stand on the nodes 3, 4 and 5 and
/// take the force as momentum. Periodic across, so that all is one row of nodes; unit cells and unit modulus.
std::string line(const std::string& shape) {
  return R"({"dimension": 2, "backend": "reference", "grid": {"cell_size": 1, "domain": [[0, 0], [9, 1]],
      "boundaries": {"x_min": "free", "x_max": "free", "y_min": "periodic", "y_max": "periodic"}},
      "shape": {"type": ")" +
         shape + R"("}, "transfer": {"type": "pic"},
      "materials": {"soft": {"type": "linear_elastic", "youngs_modulus": 1, "poisson_ratio": 0, "density": 1},
                    "heavy": {"type": "linear_elastic", "youngs_modulus": 1, "poisson_ratio": 0, "density": )" +
         digits(heavy) + R"(}},
      "bodies": [{"name": "loaded", "material": "soft", "particles_per_cell_axis": 2,
                  "geometry": {"type": "box", "lower": [4, 0], "upper": [4.5, 0.5]}},
                 {"name": "probes", "material": "heavy", "particles_per_cell_axis": 1,
                  "geometry": {"type": "box", "lower": [3, 0], "upper": [6, 1]}}],
      "solver": {"time_step": )" +
         digits(dt) + R"(, "end_time": 1}, "output": {"ledger": false}})";
}

/// Writes `value` over the first component of the first field of that name, as the reference backend saves it.
std::vector<char> with_first(std::vector<char> bytes, const std::string& field, double value) {
  const auto found = std::search(bytes.begin(), bytes.end(), field.begin(), field.end());
  REQUIRE(found != bytes.end());
  std::memcpy(&*found + field.size(), &value, sizeof value);
  return bytes;
}

/// The momenta of the three probes over dt after one step, the loaded particle being at x.
std::vector<double> forces(const std::string& shape, double x) {
  const Experiment experiment = experiment_from(line(shape));
  Simulation simulation(experiment, [x](const Experiment& e, const Plan& p, std::vector<SeededBody> bodies) {
    SeedArrays loaded = bodies[0].arrays(), probes = bodies[1].arrays();
    loaded.position[0] = x;
    for (std::size_t k = 0; k < 6; k += 2) probes.position[k] -= 0.5;
    bodies[0].replace(std::move(loaded)), bodies[1].replace(std::move(probes));
    return backend_factory(1)(e, p, std::move(bodies));
  });
  ArchiveWriter saved;
  simulation.save(saved);
  const std::vector<char> bytes = with_first(saved.bytes(), "deformation_gradient", stretch);
  ArchiveReader reader(bytes);
  simulation.restore(reader);
  REQUIRE(simulation.backend().body_state(0).material_state.at("deformation_gradient")[0] == stretch);
  simulation.step();
  const BodyState probes = simulation.backend().body_state(1);
  std::vector<double> found;
  for (std::size_t k = 0; k < 3; ++k) found.push_back(probes.mass * probes.velocity[2 * k] / dt);
  return found;
}

}  // namespace

TEST_CASE("the force of a node jumps by sigma V / h at a cell face on tents, on wider shapes it does not", "[kernel]") {
  const LinearElastic::Constants<double> constants({1, 0, 1});
  const double pull = 0.25 * LinearElastic::kirchhoff_stress(
                                 constants, LinearElastic::State<2, double>{Mat<2, double>{{stretch, 0, 0, 1}}})(0, 0);
  REQUIRE(pull > 0.05);
  std::printf("Jump of the forces of nodes 3, 4, 5 over sigma V / h, a particle crossing node 4\n");
  for (const Plugin* plugin : plugins().of_kind(MPM_SHAPE))
    for (const double place : {4.0, 4.25, 4.5}) {
      const std::string shape(plugin->id());
      const auto before = forces(shape, std::nextafter(place, 0)), after = forces(shape, std::nextafter(place, 9));
      double jump[3];
      for (int k = 0; k < 3; ++k) jump[k] = (after[k] - before[k]) / pull;
      if (place == 4) std::printf("  %-17s %9.1e %9.1e %9.1e\n", shape.c_str(), jump[0], jump[1], jump[2]);
      INFO(shape << " at " << place << ": " << jump[0] << " " << jump[1] << " " << jump[2]);
      CHECK(std::abs(after[0] - after[2]) > 0.1 * pull);  // the crossing is felt
      const bool crosses = shape == "linear" && place == 4;
      // On tents a probe sees its own node, whose mass is its own and, of the middle one, the loaded particle's.
      const double loaded = 1 / (1 + 0.25 / heavy);
      CHECK(std::abs(jump[0] - (crosses ? -1 : 0)) < 1e-12);
      CHECK(std::abs(jump[1] - (crosses ? 2 * loaded : 0)) < 1e-12);
      CHECK(std::abs(jump[2] - (crosses ? -1 : 0)) < 1e-12);
    }
}
