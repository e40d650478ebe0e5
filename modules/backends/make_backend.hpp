#pragma once
// The backends by name.

#include "simulation/simulation.hpp"

namespace mpm {

/// Makes the backend that Experiment::backend names; `threads` >= 1 is used by the cpu backend.
BackendFactory backend_factory(int threads = 1);

}  // namespace mpm
