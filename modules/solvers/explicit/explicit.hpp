#pragma once
// The explicit solver takes symplectic Euler steps, with the stress updated first, last, last from mapped-back
// velocities, or half first and half last (docs/method.md).

#include <vector>

#include "plan/step_builder.hpp"
#include "solvers/solver.hpp"

namespace mpm {

std::vector<ParameterSpec> explicit_parameters();
void read_explicit(const Fields& fields, SolverSpecification& solver);
void explicit_step(StepBuilder& step);
StepLimit explicit_limit(const Experiment& experiment, const TimeStepSpeeds& speeds);

}  // namespace mpm
