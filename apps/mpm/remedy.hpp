#pragma once
// What to change after a run that became unstable or invalid.

#include <string>

namespace mpm::app {

/// The remedy that fits the cause of a RunFailure, as a line for standard error.
std::string remedy_for(const std::string& cause);

}  // namespace mpm::app
