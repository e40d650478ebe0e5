#pragma once
// What a scene needs of memory, before anything is allocated.

#include "plan/plan.hpp"

namespace mpm {

/// Free memory of the machine, or what its control group leaves, bytes.
double available_bytes();

/// Fills in the plan's estimates. Throws InputError where the machine, or its control group, has too little memory.
void estimate_memory(Plan& plan, const Experiment& experiment);

}  // namespace mpm
