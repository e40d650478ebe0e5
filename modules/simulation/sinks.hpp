#pragma once
// Sinks at work: which particles they take out.

#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

/// Whether any sink looks at the particles after so many steps.
bool sinks_are_due(const Experiment& experiment, double time, long steps);
/// Marks the particles of each body that sinks take out then, in the order of seeding.
std::vector<std::vector<bool>> caught_by_sinks(const Experiment& experiment, const Backend& backend, double time,
                                               long steps);

}  // namespace mpm
