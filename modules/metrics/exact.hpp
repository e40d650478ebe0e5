#pragma once
// Exact solutions that experiments name under compare/exact: where each particle should be, and totals that are known.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "experiment/read.hpp"
#include "simulation/simulation.hpp"

namespace mpm {

/// What is exact at time t for a particle that started at X with velocity V. Lengths m, times s.
class ExactSolution {
 public:
  virtual ~ExactSolution() = default;
  virtual Vector3 position(const Vector3& X, const Vector3& V, double t) const = 0;
  virtual Vector3 velocity(const Vector3& X, const Vector3& V, double t) const = 0;
};

/// Descriptions of all exact solutions, for the reader and the schema.
std::vector<ExactDescription> exact_solutions();

/// The exact solution that an experiment names; null when it names none. `dt` is the fixed step of discrete solutions
/// (free_fall), s.
std::unique_ptr<ExactSolution> make_exact_solution(const Experiment& experiment, double dt);

}  // namespace mpm
