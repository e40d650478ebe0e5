#pragma once
// Checks of a run that has been seeded and has taken no step, and words for one that stopped.

#include <string>

#include "experiment/diagnostics.hpp"
#include "simulation/imposed_value.hpp"
#include "simulation/simulation.hpp"

namespace mpm::app {

/// A problem at a JSON pointer of the experiment, with its line and column where the file has it.
Problem problem_at(const Experiment& experiment, const std::string& pointer, const std::string& message);

/// Throws InputError where a particle begins with a velocity or a temperature that cannot be, or where a formula of the
/// first step imposes one.
void refuse_impossible_starts(const Simulation& simulation);

/// Why and where a simulation stopped: "step 3, t = 0.1 s: particle 4 of body "b" at (2, 0) m left the domain".
std::string failure_text(const Failure& failure, const Simulation& simulation);
std::string failure_text(const ImposedValue& imposed, const Simulation& simulation);

}  // namespace mpm::app
