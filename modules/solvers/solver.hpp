#pragma once
// A solver: how a step is made of operators, and how long it may be.

#include <span>
#include <string>
#include <string_view>

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
  /// Writes one step of time.
  void (*step)(StepBuilder&);
  /// The step that the measured speeds allow, s, `courant` and the filter's own limit included.
  StepLimit (*limit)(const Experiment&, const TimeStepSpeeds&);
};

/// All there are; the one that an experiment names.
std::span<const Solver> solvers();
const Solver& solver_of(const Experiment& experiment);

/// Throws InputError when components cannot be combined, naming both and the reason, and when the scene needs more
/// memory than the machine has (before anything is allocated).
Plan make_plan(const Experiment& experiment);

}  // namespace mpm
