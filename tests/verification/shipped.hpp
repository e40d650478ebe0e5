#pragma once
// Experiments as they are shipped, and tables of errors over grids.

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "solvers/solver.hpp"
#include "support/scene.hpp"

namespace mpm::test {

/// The shipped experiment at `path` below experiments/.
inline Experiment shipped(const std::string& path, const std::vector<std::string>& overrides = {}) {
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.overrides = overrides;
  options.exact = exact_solutions();
  return read_experiment(std::string(MPM_SOURCE_DIR "/experiments/") + path, ComponentLookup(plugins()), options);
}

/// A run of a shipped experiment; one that stops on the way keeps the reason.
class ShippedScene {
 public:
  explicit ShippedScene(const std::string& path, const std::vector<std::string>& overrides = {})
      : experiment(shipped(path, overrides)), simulation(experiment, backend_factory(1)), metrics(simulation) {}

  /// Runs to the end and returns the totals there. `each` is called after every step.
  Totals run(const std::function<void()>& each = {}) {
    try {
      while (!simulation.finished()) {
        simulation.step();
        if (each) each();
      }
    } catch (const RunFailure& stopped) {
      failure = cause_text(stopped.failure, experiment);
    }
    return metrics.measure();
  }

  const Experiment experiment;
  Simulation simulation;
  Metrics metrics;
  std::string failure;  ///< empty when the run came to its end
};

/// Prints a row of errors with the orders between neighbours; NaN where a run stopped.
inline void print_orders(const std::string& name, const std::vector<double>& sizes, const std::vector<double>& errors) {
  std::printf("  %-28s", name.c_str());
  for (const double error : errors) std::printf(" %10.3e", error);
  for (std::size_t k = 1; k < sizes.size(); ++k)
    std::printf(" %6.2f", std::log(errors[k - 1] / errors[k]) / std::log(sizes[k - 1] / sizes[k]));
  std::printf("\n");
}

}  // namespace mpm::test
