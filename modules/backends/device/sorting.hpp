#pragma once
// What a device keeps to work on a body's particles in blocks of cells (kernels/sorting.hpp): where each particle is, and
// the list of the blocks that have any.

#include <algorithm>

#include "backends/device/device.hpp"
#include "backends/device/kernels/sorting.hpp"

namespace mpm::device {

/// The blocks of one body, on the device.
class Blocks {
 public:
  /// `scene` holds cells and padding.
  template <class T>
  Blocks(Device& device, const std::string& body, const Arguments<T>& scene, int dimension, std::size_t particles)
      : table_(table_of(scene, dimension)),
        of_particle_(device, "the blocks of " + body, 2 * particles),
        of_table_(device, "the blocks of " + body, 2 * static_cast<std::size_t>(table_.table)),
        of_chunks_(device, "the blocks of " + body, 4 * static_cast<std::size_t>(chunks())),
        of_list_(device, "the blocks of " + body, 4 * static_cast<std::size_t>(most(particles)) + 1),
        state_(device, "the blocks of " + body) {
    of_particle_.fill(0xff);  // no particle is in any block yet
    state_.upload({1, 0});
    table_.block = of_particle_.data(), table_.order = of_particle_.data() + particles;
    table_.count = of_table_.data(), table_.next = of_table_.data() + table_.table;
    table_.chunk = of_chunks_.data(), table_.before_chunk = of_chunks_.data() + 2 * static_cast<std::size_t>(chunks());
    table_.begin = of_list_.data(), table_.cell = of_list_.data() + most(particles) + 1;
    table_.in_order = state_.data(), table_.active = state_.data() + 1;
  }

  const BlockArrays& table() const { return table_; }
  /// The chunks in which the blocks of the table are numbered.
  int chunks() const { return (table_.table + chunk_of_blocks - 1) / chunk_of_blocks; }
  /// The most blocks that so many particles may be in.
  int most(std::size_t particles) const {
    return static_cast<int>(std::min(particles, static_cast<std::size_t>(table_.table)));
  }

 private:
  template <class T>
  static BlockArrays table_of(const Arguments<T>& scene, int dimension) {
    BlockArrays table{};
    table.table = 1;
    for (int c = 0; c < dimension; ++c) {
      table.lower[c] = -((scene.padding[c] + block_cells - 1) / block_cells);
      table.extent[c] = (scene.cells[c] + scene.padding[c]) / block_cells - table.lower[c] + 1;
      table.table *= table.extent[c];
    }
    return table;
  }

  BlockArrays table_;
  DeviceArray<int> of_particle_, of_table_, of_chunks_, of_list_, state_;
};

}  // namespace mpm::device
