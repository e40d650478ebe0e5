#pragma once
// Numbers the fields of a scene for its kernels: those of the plan, and those in which a value waits from one phase to
// a later one.

#include <string_view>
#include <vector>

#include "plan/plan.hpp"

namespace mpm::device {

/// The fields of the nodes, in the order of their numbers.
std::vector<Field> node_fields(const Experiment& experiment, const Plan& plan);

/// The fields of one body's particles. The state of the material comes last, so that the numbers before it are those of
/// all bodies. Positions as seeded are among them where a kernel reads them.
std::vector<Field> particle_fields(const Experiment& experiment, const Plan& plan, int body);

/// The number of the first field with this id and origin; -1 where there is none.
int number_of(const std::vector<Field>& fields, std::string_view id, Origin origin = Origin::host);
/// The number of the first field with this origin; -1 where there is none.
int first_of(const std::vector<Field>& fields, Origin origin);

}  // namespace mpm::device
