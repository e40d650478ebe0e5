#pragma once
// A solver says how a step is made of operators, and how long the step may be.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/read.hpp"
#include "plan/step_builder.hpp"

namespace mpm {

/// The speeds that a backend measures for the automatic time step, at the particle with the largest sum of both.
struct TimeStepSpeeds {
  double speed = 0;  ///< wave speed + particle speed, m/s
};

/// The largest step that a solver takes.
struct StepLimit {
  double seconds = 0;
  std::string_view reason;  ///< "wave", "shape", "stress update", "filter order", "diffusion", "convection"
  bool by_speed = false;    ///< the measured speeds limit it, so that their particle is the one to name
};

struct Solver {
  std::string_view id, summary;
  /// The keys of the file's solver section, `end_time_parameter()` and `max_steps_parameter()` among them, in the order
  /// in which they are listed; `read` takes the values of the other keys.
  std::vector<ParameterSpec> (*parameters)();
  void (*read)(const Fields&, SolverSpecification&);
  /// Writes the operators of one time step.
  void (*step)(StepBuilder&);
  /// The largest step, s, that the measured speeds allow, with `courant` and the filter's own limit included.
  StepLimit (*limit)(const Experiment&, const TimeStepSpeeds&);
};

/// All solvers, the one that is meant where a file names none first; and the one that an experiment names.
std::span<const Solver> solvers();
const Solver& solver_of(const Experiment& experiment);

/// The descriptions of all solvers for `ReadOptions::solvers`.
std::vector<SolverDescription> solver_descriptions();

/// Makes the plan of an experiment. Throws InputError when components cannot be combined, naming both and the reason,
/// and when the scene needs more memory than the machine has (before anything is allocated).
Plan make_plan(const Experiment& experiment);

}  // namespace mpm
