#pragma once
// The fields of a scene as its kernels number them: those of the plan, and those in which a value waits from one phase
// to a later one.

#include <string_view>
#include <vector>

#include "plan/plan.hpp"

namespace mpm::device {

/// Of the nodes, in the order of their numbers.
std::vector<Field> node_fields(const Experiment& experiment, const Plan& plan);

/// Of one body's particles. The state of the material comes last, so that the numbers before it are those of all
/// bodies. Positions as seeded, which no kernel reads, are not among them.
std::vector<Field> particle_fields(const Experiment& experiment, const Plan& plan, int body);

/// Number of the first field with this id and origin; -1 where there is none.
int number_of(const std::vector<Field>& fields, std::string_view id, Origin origin = Origin::host);
/// Number of the first field with this origin; -1 where there is none.
int first_of(const std::vector<Field>& fields, Origin origin);

}  // namespace mpm::device
