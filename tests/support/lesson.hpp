#pragma once
// A lesson's experiment as it stands in experiments/lessons, and what the pages of docs/lessons say of it.

#include <algorithm>
#include <string>
#include <vector>

#include "solvers/solver.hpp"
#include "support/larger.hpp"
#include "support/scene.hpp"

namespace mpm::test {

struct Lesson {
  explicit Lesson(const std::string& name, const std::vector<std::string>& overrides = {})
      : experiment(read(name, overrides)), simulation(experiment, backend_factory(1)), metrics(simulation) {}

  Totals step() {
    simulation.step();
    const Totals now = metrics.measure();
    smallest_volume_ratio = smaller(smallest_volume_ratio, now.smallest_volume_ratio);
    largest_volume_ratio = larger(largest_volume_ratio, now.largest_volume_ratio);
    largest_energy = larger(largest_energy, now.total_energy());
    return now;
  }
  Totals run() {
    while (!simulation.finished()) step();
    return metrics.measure();
  }

  const Experiment experiment;
  Simulation simulation;
  Metrics metrics;
  double smallest_volume_ratio = 1, largest_volume_ratio = 1;
  double largest_energy = 0;

 private:
  static Experiment read(const std::string& name, const std::vector<std::string>& overrides) {
    ReadOptions options;
    options.solvers = solver_descriptions();
    options.overrides = overrides;
    options.exact = exact_solutions();
    return read_experiment(std::string(MPM_SOURCE_DIR "/experiments/lessons/") + name + ".json",
                           ComponentLookup(plugins()), options);
  }
};

inline double kept_energy(const Lesson& lesson, const Totals& end) {
  return end.total_energy() / lesson.metrics.initial().total_energy();
}

}  // namespace mpm::test
