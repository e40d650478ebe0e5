#pragma once
// The memory that a run takes on a device, by the list of its fields.

#include "backends/device/device.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// What a field, or what is kept beside the fields, takes on a device.
struct TakenMemory {
  std::string field;
  int body = -1;  ///< whose particles; -1: the nodes
  int components = 1;
  double bytes = 0;
  bool working = false;  ///< holds nothing between steps
};

/// What `particles` of each body and so many nodes of the grid take, for all velocity fields.
std::vector<TakenMemory> taken_memory(const Experiment& experiment, const Plan& plan,
                                      const std::vector<std::size_t>& particles, std::size_t nodes);

/// Throws DeviceError where the device has less memory free than the fields of particles and nodes will take; the
/// message says how much is asked and free, and which fields take most.
void refuse_what_does_not_fit(const Device& device, const Experiment& experiment, const Plan& plan,
                              const std::vector<SeededBody>& seeded, std::size_t nodes);

}  // namespace mpm::device
