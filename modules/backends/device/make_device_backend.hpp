#pragma once
// Makes the backend of a device.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "backends/device/compose.hpp"
#include "backends/device/drivers/driver.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// Which device, and how its program is made.
struct DeviceSetup {
  const Driver* driver = nullptr;
  int number = 0;  ///< of the device among the driver's
  int lanes = 32;  ///< of a team, 1 to 256
  /// Makes the machine code of a composition for an architecture ("sm_90"). Its exceptions are passed on.
  std::function<std::string(const Composition&, const std::string& architecture)> compile;
  bool graphs = true;  ///< steps that need nothing of the host are launched as graphs
  int teams = 0;       ///< that share the blocks of particles; 0: as many as the device may work on at once
  /// Steps after which the grid is forgotten (kernels/active_nodes.hpp). Behind a body the nodes that it has left stay active
  /// as long.
  long steps_to_forget = 16;
  /// Particles near a node that a lane has room for where contact looks at particles; -1: as many as the scene asks for.
  /// Nodes that see more find them anew each time, with the same outcome.
  int contact_row = -1;
};

/// Makes the backend; `plan` is that of an experiment with the backend "cuda". All memory is taken here. Throws
/// DeviceError where the device is missing or too small, what `compile` throws, and std::invalid_argument for a team
/// that shared memory has no room for.
std::unique_ptr<Backend> make_device_backend(const Experiment& experiment, const Plan& plan,
                                             const std::vector<SeededBody>& seeded, const DeviceSetup& setup);

}  // namespace mpm::device
