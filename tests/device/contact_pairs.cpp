// The force of each pair of fields on the device.

#include "device/device_support.hpp"
#include "support/stacked_blocks.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("on the device too a pair's force is what the block above it feels") {
  for (const auto& [transfer, filter] : stacked_schemes()) {
    INFO(transfer << filter);
    DeviceScene scene(stacked_blocks("reference", transfer, filter, "[0, -0.2]"), "double");
    check_newton(scene.simulation, 12, 1e-8);
  }
}
