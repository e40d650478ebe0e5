#pragma once
// The tables of an experiment file whose solver is a material point.

#include <string>
#include <vector>

#include "experiment/parameter.hpp"

namespace mpm::drive {

Section drive_section();
Section solver_section();
Section stage_section(int dimension);

/// The components of a matrix, "xx", "xy", … row by row, and those of a stress, upper ones alone. In 2-D those in the
/// plane.
std::vector<std::string> components_of_matrix(int dimension);
std::vector<std::string> components_of_stress(int dimension);

}  // namespace mpm::drive
