#pragma once
// Makes the backend that an experiment names.

#include "simulation/simulation.hpp"

namespace mpm {

/// Makes the backend that Experiment::backend names. The cpu backend uses `threads` >= 1, or with `find_number` as many
/// of them as are fastest. Results do not depend on the number.
BackendFactory backend_factory(int threads = 1, bool find_number = false);

}  // namespace mpm
