#pragma once
// A run on the host-run device: the passes of a plan as phases of a composition. What it does between phases (allocate,
// sort particles into blocks, launch, look at failures and norms) is what a launch layer on a GPU has to do.

#include "backends/device/drivers/host_device.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// `device` is a composition of choice_of(experiment); a team has 1 to 256 lanes.
/// Throws std::invalid_argument for what kernels do not do yet: prescribed walls, boxes of conditions, body forces and
/// the energy ledger ("/output/ledger": false turns it off).
std::unique_ptr<Backend> make_host_run(const Experiment& experiment, const Plan& plan,
                                       const std::vector<SeededBody>& seeded, const HostDevice& device,
                                       const TeamShape& team);

}  // namespace mpm::device
