// How large a scene is on a device, counted from the experiment, for tests of what a run takes.
#pragma once

#include "backends/device/memory.hpp"
#include "backends/device/sorting.hpp"
#include "device/device_support.hpp"
#include "simulation/boundary.hpp"

namespace mpm::test {

/// The nodes, blocks and particles of a two-dimensional scene in the lanes of the usual device.
inline device::SceneSize scene_size(const Experiment& experiment, const Backend& backend) {
  device::Arguments<double> scene{};
  device::SceneSize size{{}, 1, 0, device_setup().lanes};
  for (int c = 0; c < 2; ++c) {
    scene.cells[c] = experiment.grid.cells[c], scene.padding[c] = grid_padding_of(experiment.shape.plugin->shape());
    size.nodes *= static_cast<std::size_t>(scene.cells[c] + 1 + 2 * scene.padding[c]);
  }
  size.blocks = device::table_of_blocks(scene, 2).table;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
    size.particles.push_back(backend.body_state(body).position.size() / 2);
  return size;
}

}  // namespace mpm::test
