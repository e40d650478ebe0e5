#pragma once
// A solver: how a step is made of operators, and how long it may be.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/read.hpp"
#include "plan/step_builder.hpp"

namespace mpm {

/// What a backend measures for the automatic time step, of the particle with the largest sum of both.
struct TimeStepSpeeds {
  double speed = 0;  ///< wave speed + particle speed, m/s
};

/// The largest step that a solver takes.
struct StepLimit {
  double seconds = 0;
  std::string_view reason;  ///< "wave", "filter order", "diffusion", "convection"
};

struct Solver {
  std::string_view id, summary;
  /// Keys of the file's solver section, `end_time_parameter()` and `max_steps_parameter()` among them, in the order in
  /// which they are listed; and what the others say.
  std::vector<ParameterSpec> (*parameters)();
  void (*read)(const Fields&, SolverSpecification&);
  /// Writes one step of time.
  void (*step)(StepBuilder&);
  /// The step that the measured speeds allow, s, `courant` and the filter's own limit included.
  StepLimit (*limit)(const Experiment&, const TimeStepSpeeds&);
};

/// All there are, the one that is meant where a file names none first; the one that an experiment names.
std::span<const Solver> solvers();
const Solver& solver_of(const Experiment& experiment);

/// All of them for `ReadOptions::solvers`.
std::vector<SolverDescription> solver_descriptions();

/// Throws InputError when components cannot be combined, naming both and the reason, and when the scene needs more
/// memory than the machine has (before anything is allocated).
Plan make_plan(const Experiment& experiment);

}  // namespace mpm
