// Every experiment that the project ships, with the outputs that it asks for, on the host driver beside another backend.

#include "device/shipped.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>

#include "backends/device/program.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

namespace fs = std::filesystem;

/// Where rounding alone decides how a scene begins, as bodies touch at the very distance at which contact acts, or a grip has
/// half of a node's mass: jitter of these bodies takes it off the tie.
std::vector<std::string> settings_of(const fs::path& file, const std::string& precision) {
  static const std::map<std::string, std::vector<int>> tied{
      {"studies/bars_of_unlike_mass.json", {0, 1}},
      {"studies/cracking_bar.json", {0, 2}},
      {"studies/rigid_corner.json", {0}},
  };
  std::vector<std::string> settings{set("/precision", precision)};
  if (const auto found = tied.find(shipped_name(file)); found != tied.end())
    for (const int body : found->second) settings.push_back(set("/bodies/" + std::to_string(body) + "/jitter", "0.2"));
  return settings;
}

/// A shipped experiment on a backend.
class Shipped {
 public:
  Shipped(const fs::path& file, const std::string& backend, const std::string& precision)
      : experiment(read_shipped(file, backend, settings_of(file, precision))),
        simulation(experiment, backend_factory(1, false, "host")),
        metrics(simulation) {}
  void steps(int count) {
    for (int k = 0; k < count; ++k) simulation.step();
  }
  BodyState body(int index) const { return simulation.backend().body_state(index); }

  const Experiment experiment;
  Simulation simulation;
  Metrics metrics;
};

/// Programs of the device are kept beside the build, as compiling one takes longer than these runs.
struct KeptPrograms {
  KeptPrograms() { setenv("MPM_CACHE", folder_of_programs("programs_of_tests").c_str(), 1); }
  ~KeptPrograms() { unsetenv("MPM_CACHE"); }
};

/// Largest difference of two states, each value over the scene's scale of it. `speed` is that of cells a step: rounding
/// of a strain, which is about 1, makes rounding of the velocity of its waves.
double scaled_difference(const Experiment& experiment, const BodyState& expected, const BodyState& found,
                         double speed) {
  const double h = experiment.grid.cell_size;
  double length = 0;  // what a coordinate rounds by
  for (int c = 0; c < experiment.dimension; ++c)
    length = larger(length, larger(std::abs(experiment.grid.lower[c]), std::abs(experiment.grid.upper[c])));
  double worst = std::max(difference(expected.position, found.position, length),
                          difference(expected.velocity, found.velocity, speed));
  worst = larger(worst, difference(expected.domain, found.domain, h));
  worst = larger(worst, difference(expected.corners, found.corners, h));
  worst = larger(worst, difference(expected.second_moment, found.second_moment, h * h));
  for (const auto& [name, values] : expected.transfer_state)
    worst = larger(worst, difference(values, found.transfer_state.at(name), speed / h));
  for (const auto& [name, values] : expected.material_state)
    worst = larger(worst, difference(values, found.material_state.at(name), size_of(values)));
  return worst;
}

/// Steps both backends and compares particles, energies and the ledger. The bounds are of `factor` times what values
/// round by: that grows with cells away from the origin, as weights are made of positions over the cell size.
void compare(const fs::path& file, const std::string& other, const std::string& precision, int steps, double factor) {
  INFO(shipped_name(file) << ", " << precision << ", " << steps << " steps, against " << other);
  Shipped device(file, "cuda", precision), expected(file, other, precision);
  device.steps(steps), expected.steps(steps);
  const Experiment& experiment = device.experiment;
  const double epsilon = epsilon_of(precision), h = experiment.grid.cell_size;
  const double speed = h / device.simulation.last_time_step();
  CHECK(std::abs(device.simulation.time() / expected.simulation.time() - 1) < factor * epsilon);
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
    CHECK(scaled_difference(experiment, expected.body(body), device.body(body), speed) / (factor * epsilon) < 1);
  const Totals there = expected.metrics.measure(), here = device.metrics.measure();
  const double margin = factor * epsilon * speed * std::sqrt(there.mass * there.kinetic);
  CHECK(std::abs(here.kinetic - there.kinetic) <= margin);
  CHECK(std::abs(here.mass / there.mass - 1) < factor * epsilon);
  // Stored energies are differences of terms as large as the stiffness, at most m speed^2, and round as these do.
  const double energy = there.kinetic + there.strain, stiff = there.mass * speed * speed;
  const double bound = 45 * factor * epsilon;
  CHECK(ledger_difference(ledger_values(expected), ledger_values(device), energy + epsilon / bound * stiff) < bound);
}

/// A choice of experiments with few particles that need different programs between them. Scenes of papers, each of which
/// needs a program of its own that takes long to compile, are left to the test of every experiment.
std::vector<fs::path> covering_choice(double most_particles) {
  std::vector<fs::path> chosen;
  std::set<std::string> programs;
  for (const fs::path& file : shipped_experiments()) {
    if (shipped_name(file).starts_with("papers/")) continue;
    const Experiment experiment = read_shipped(file, "cuda");
    const Plan plan = make_plan(experiment);
    const device::Composition composition = device::compose(device::choice_of(experiment, plan));
    if (static_cast<double>(plan.particles) <= most_particles && programs.insert(composition.hash).second)
      chosen.push_back(file);
  }
  return chosen;
}

}  // namespace

TEST_CASE("what a run folder keeps of a shipped experiment is read again as the same one", "[shipped]") {
  const TemporaryFolder folder;
  for (const fs::path& file : shipped_experiments()) {
    INFO(shipped_name(file));
    const Experiment experiment = read_shipped(file, "cpu");
    std::ofstream(folder / "experiment.json") << experiment.resolved.dump(2);
    const Experiment again = read_experiment(folder / "experiment.json", plugins(), app::read_options(plugins(), {}));
    CHECK(nlohmann::ordered_json::diff(again.resolved, experiment.resolved).dump() == "[]");
  }
}

TEST_CASE("shipped experiments begin on the host-run device as on the reference backend", "[device][shipped]") {
  const KeptPrograms programs;
  const std::vector<fs::path> chosen = covering_choice(1500);
  CHECK(chosen.size() >= 12);
  for (const fs::path& file : chosen) compare(file, "reference", "double", 3, 1e3);
}

TEST_CASE("every shipped experiment runs on the host-run device as on the cpu backend", "[device][shipped][slow]") {
  const KeptPrograms programs;
  const std::vector<fs::path> files = shipped_experiments();
  CHECK(files.size() >= 45);
  for (const fs::path& file : files) {
    compare(file, "cpu", "double", 10, 1e3);
    if (read_shipped(file, "cuda").precision == Precision::single) compare(file, "cpu", "float", 10, 1e3);
  }
}
