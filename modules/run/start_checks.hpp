#pragma once
// Checks of a run that has been seeded and has taken no step, and words for one that stopped.

#include <string>
#include <vector>

#include "experiment/diagnostics.hpp"
#include "simulation/formula_problem.hpp"
#include "simulation/imposed_value.hpp"
#include "simulation/simulation.hpp"

namespace mpm::app {

/// Looks at a run before its first step. Throws InputError where a particle begins with a velocity or a temperature that
/// cannot be, where a formula of the first step imposes one, and where two bodies are the same. Returns warnings of what is
/// legal and yet does not do what it seems to: bodies that begin in one place or in a rigid body, damping of nothing.
std::vector<std::string> check_start(const Simulation& simulation);

/// Why and where a simulation stopped: "step 3, t = 0.1 s: particle 4 of body "b" at (2, 0) m left the domain".
std::string failure_text(const Failure& failure, const Simulation& simulation);
std::string failure_text(const ImposedValue& imposed, const Simulation& simulation);

}  // namespace mpm::app
