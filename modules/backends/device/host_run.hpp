#pragma once
// A run on the host-run device executes the passes of a plan as phases of a composition. What it does between phases
// (allocate, sort particles into blocks, launch, look at failures and norms) is what a launch layer on a GPU has to do.

#include "backends/device/drivers/host_device.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// Makes the backend of such a run. `device` is a composition of choice_of(experiment, plan), and the plan that of an
/// experiment with the backend "device". Throws std::invalid_argument where a team has not 1 to 256 lanes.
std::unique_ptr<Backend> make_host_run(const Experiment& experiment, const Plan& plan,
                                       const std::vector<SeededBody>& seeded, const HostDevice& device,
                                       const TeamShape& team);

}  // namespace mpm::device
