#pragma once
// What the section `contact` of an experiment says beside its law, normal and detection.

#include "experiment/experiment.hpp"

namespace mpm {

/// By how much contact may strain a cell in one correction of a pair, dt |dv| / h; 0 where nothing limits it.
double strain_cap_of(const Experiment& experiment);

/// Why a law or a normal takes no cap; empty where it takes one.
std::string refuses_strain_cap(const Component& law, const Component& normal);

}  // namespace mpm
