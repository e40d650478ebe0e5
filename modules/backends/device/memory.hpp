#pragma once
// The memory that a run takes on a device, by the list of its fields.

#include "backends/device/device.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// Throws DeviceError where the device has less memory free than the fields of particles and nodes will take; the
/// message says how much is asked and free, and which fields take most.
void refuse_what_does_not_fit(const Device& device, const Experiment& experiment, const Plan& plan,
                              const std::vector<SeededBody>& seeded, std::size_t nodes);

}  // namespace mpm::device
