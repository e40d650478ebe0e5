#pragma once
// A run from the text of an experiment: what verification, parity and stability tests share.

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "backends/make_backend.hpp"
#include "experiment/read.hpp"
#include "metrics/metrics.hpp"
#include "solvers/solver.hpp"

namespace mpm::test {

/// Every plugin of the build, loaded once.
inline const Registry& plugins() {
  static const Registry registry = Registry::from_folders(Registry::default_folders());
  return registry;
}

/// Overrides that put bodies without a seeding on the grid's lattice: tests are of the step, and know where particles lie.
inline std::vector<std::string> on_the_lattice(const std::string& text) {
  std::vector<std::string> overrides;
  const auto scene = nlohmann::json::parse(text, nullptr, false, true);
  if (!scene.is_object() || !scene.contains("bodies")) return overrides;
  for (std::size_t body = 0; body < scene["bodies"].size(); ++body)
    if (scene["bodies"][body].is_object() && !scene["bodies"][body].contains("seeding"))
      overrides.push_back("/bodies/" + std::to_string(body) + "/seeding=lattice");
  return overrides;
}

inline Experiment experiment_from(const std::string& text, const std::vector<std::string>& overrides = {}) {
  ReadOptions options;
  options.solvers = solver_descriptions();
  options.overrides = on_the_lattice(text);
  options.overrides.insert(options.overrides.end(), overrides.begin(), overrides.end());
  options.exact = exact_solutions();
  return read_experiment_text(text, "test.json", ComponentLookup(plugins()), options);
}

class Scene {
 public:
  explicit Scene(const std::string& text, const std::vector<std::string>& overrides = {}, int threads = 1)
      : experiment(experiment_from(text, overrides)),
        simulation(experiment, backend_factory(threads)),
        metrics(simulation) {}

  /// Runs to the end; returns the totals there.
  Totals run() {
    while (!simulation.finished()) simulation.step();
    return metrics.measure();
  }
  Totals run_steps(long count) {
    for (long k = 0; k < count; ++k) simulation.step();
    return metrics.measure();
  }
  BodyState body(int index = 0) const { return simulation.backend().body_state(index); }

  const Experiment experiment;
  Simulation simulation;
  Metrics metrics;
};

/// A number with all its digits.
inline std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

inline std::string set(const std::string& pointer, const std::string& value) {
  return pointer + "=" + value;
}

/// Each shape with each transfer, but for PolyPIC on lists of nodes, which have no axes and are refused by name
/// (polynomial.cpp).
inline std::vector<std::pair<std::string, std::string>> pairs_of(const std::vector<std::string>& shapes,
                                                                 const std::vector<std::string>& transfers) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const std::string& shape : shapes)
    for (const std::string& transfer : transfers)
      if (transfer != "polypic" || !shape.starts_with("cpdi")) pairs.emplace_back(shape, transfer);
  return pairs;
}

/// Slope of log(error) against log(size) between the last two entries: the observed order.
inline double observed_order(const std::vector<double>& sizes, const std::vector<double>& errors) {
  const std::size_t n = sizes.size();
  return std::log(errors[n - 2] / errors[n - 1]) / std::log(sizes[n - 2] / sizes[n - 1]);
}

}  // namespace mpm::test
