#pragma once
// Problems that arise after reading, at their places in the file.

#include <string>

#include "experiment/diagnostics.hpp"
#include "experiment/experiment.hpp"

namespace mpm {

/// A problem at a JSON pointer of the experiment, with the line and column of the value, or of the nearest part of the
/// file around it.
Problem problem_at(const Experiment& experiment, const std::string& pointer, const std::string& message);

}  // namespace mpm
