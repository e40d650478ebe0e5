// The experiments that the project ships, with the outputs that they ask for, on the host-run device.

#include <filesystem>

#include "device/device_support.hpp"
#include "support/files.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> shipped_experiments() {
  const fs::path root = fs::path(MPM_SOURCE_DIR) / "experiments";
  std::vector<fs::path> files{root / "quickstart.json"};
  for (const char* folder : {"lessons", "gallery"})
    for (const auto& entry : fs::directory_iterator(root / folder)) files.push_back(entry.path());
  return files;
}

/// Largest difference of two states, each value over the scene's scale of it. `speed` is that of cells a step: rounding
/// of a strain, which is about 1, makes rounding of the velocity of its waves.
double scaled_difference(const Experiment& experiment, const BodyState& expected, const BodyState& found,
                         double speed) {
  const double h = experiment.grid.cell_size, length = experiment.grid.upper[0] - experiment.grid.lower[0];
  double worst = std::max(difference(expected.position, found.position, length),
                          difference(expected.velocity, found.velocity, speed));
  worst = std::max(worst, difference(expected.domain, found.domain, h));
  worst = std::max(worst, difference(expected.second_moment, found.second_moment, h * h));
  for (const auto& [name, values] : expected.transfer_state)
    worst = std::max(worst, difference(values, found.transfer_state.at(name), speed / h));
  for (const auto& [name, values] : expected.material_state)
    worst = std::max(worst, difference(values, found.material_state.at(name), 1.0));
  return worst;
}

}  // namespace

TEST_CASE("shipped experiments begin on the host-run device as on the reference backend", "[device]") {
  constexpr double most_particles = 12000;  // both backends are slow
  int count = 0;
  for (const fs::path& file : shipped_experiments()) {
    INFO(file);
    const std::string text = support::read_file(file);
    const Experiment experiment = device_experiment(text, "double");
    const Plan plan = make_plan(experiment);
    REQUIRE(plan.has_ledger());  // the ledger is asked for where nothing else is said
    CHECK_NOTHROW(device::compose(device::choice_of(experiment, plan)));
    if (static_cast<double>(plan.particles) > most_particles) continue;
    ++count;
    DeviceScene scene(text, "double");
    Scene reference(text, {set("/backend", "reference"), set("/precision", "double")});
    for (int step = 0; step < 3; ++step) scene.simulation.step(), reference.simulation.step();
    const double epsilon = 0x1p-52, speed = experiment.grid.cell_size / scene.simulation.last_time_step();
    for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
      CHECK(scaled_difference(experiment, reference.body(body), scene.body(body), speed) < 1e3 * epsilon);
    const Totals expected = reference.metrics.measure(), found = scene.metrics.measure();
    const double margin = 1e3 * epsilon * speed * std::sqrt(expected.mass * expected.kinetic);
    CHECK(std::abs(found.kinetic - expected.kinetic) < margin);
    // Stored energies are differences of terms as large as the stiffness, at most m speed^2, and round as these do.
    const double energy = expected.kinetic + expected.strain, stiff = expected.mass * speed * speed;
    CHECK(ledger_difference(ledger_values(reference), ledger_values(scene), energy + 1e11 * epsilon * stiff) < 1e-11);
  }
  CHECK(count >= 10);
}
