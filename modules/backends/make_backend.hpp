#pragma once
// The backends by name.

#include "simulation/simulation.hpp"

namespace mpm {

/// Makes the backend that Experiment::backend names. The cpu backend uses `threads` >= 1, or with `find_number` as many
/// of them as are fastest. Results do not depend on it.
BackendFactory backend_factory(int threads = 1, bool find_number = false);

}  // namespace mpm
