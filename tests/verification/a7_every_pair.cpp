// Case A7 for every shape and transfer that the build has: flight under gravity over 20 cells with
// v = v0 + g n dt, x = x0 + v0 t + g t (t + dt) / 2, F = I. `ctest -V` shows the table. Every order of the stress
// update and three dimensions are in free_fall.cpp and node_lists.cpp, filters in filters.cpp.

#include <cstdio>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double dt = 0.002, velocity[2] = {8, 2}, gravity[2] = {0, -9.81};
constexpr int steps = 125;

const char* flight = R"J({
  "title": "flight", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [4, 2]], "boundaries": {"all": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "pic"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e3, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": [0.6, 1], "radius": 0.23}, "velocity": [8, 2]}],
  "gravity": [0, -9.81],
  "solver": {"time_step": 0.002, "end_time": 0.25}, "output": {"ledger": false}})J";

struct Errors {
  double position = 0, velocity = 0, deformation = 0, momentum = 0;  // the last over mass times speed
  double worst() const { return std::max({position, velocity, deformation, momentum}); }
};

Errors errors_of(Scene& scene) {
  const BodyState before = scene.body();
  const Totals start = scene.metrics.initial(), end = scene.run_steps(steps);
  const BodyState after = scene.body();
  Errors e;
  const double t = steps * dt;
  for (std::size_t k = 0; k < before.position.size(); ++k) {
    const std::size_t c = k % 2;
    const double x = before.position[k] + velocity[c] * t + gravity[c] * t * (t + dt) / 2;
    e.position = std::max(e.position, std::abs(after.position[k] / x - 1));
    e.velocity = std::max(e.velocity, std::abs(after.velocity[k] - velocity[c] - gravity[c] * t) / 8);
  }
  const std::vector<double>& F = after.material_state.at("deformation_gradient");
  for (std::size_t k = 0; k < F.size(); ++k)
    e.deformation = std::max(e.deformation, std::abs(F[k] - (k % 4 == 0 || k % 4 == 3 ? 1 : 0)));
  for (int c = 0; c < 2; ++c)
    e.momentum = std::max(
        e.momentum, std::abs(end.momentum[c] - start.momentum[c] - start.mass * gravity[c] * t) / (8 * start.mass));
  return e;
}

}  // namespace

TEST_CASE("A7 free flight of every shape with every transfer", "[A][A7]") {
  std::printf("A7, 20 cells: relative errors of position, velocity, momentum; of F\n");
  int pairs = 0;
  for (const Plugin* shape : plugins().of_kind(MPM_SHAPE))
    for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER))
      for (const std::string backend : {"reference", "cpu"}) {
        const std::string name = std::string(shape->id()) + " " + std::string(transfer->id()) + " " + backend;
        const std::vector<std::string> choice{set("/backend", backend), set("/shape/type", std::string(shape->id())),
                                              set("/transfer/type", std::string(transfer->id()))};
        std::unique_ptr<Scene> scene;
        try {
          scene = std::make_unique<Scene>(flight, choice);
        } catch (const InputError& error) {  // a pair that the checker refuses by name
          std::printf("  %-36s refused\n", name.c_str());
          continue;
        }
        const Errors e = errors_of(*scene);
        if (backend == "cpu")
          std::printf("  %-36s %.1e %.1e %.1e  %.1e\n", name.c_str(), e.position, e.velocity, e.momentum,
                      e.deformation);
        INFO(name);
        CHECK(e.worst() <= 1e-12);
        ++pairs;
      }
  CHECK(pairs >= 2 * 25);
}
