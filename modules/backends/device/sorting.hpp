#pragma once
// What a device keeps to work on a body's particles in blocks of cells (kernels/sorting.hpp): where each particle is, and
// the list of the blocks that have any.

#include <algorithm>

#include "backends/device/device.hpp"
#include "backends/device/kernels/sorting.hpp"

namespace mpm::device {

/// All blocks of cells that a grid has, ghosts too: the first one, how many along each axis, and their product. `scene`
/// holds cells and padding.
template <class T>
BlockArrays table_of_blocks(const Arguments<T>& scene, int dimension) {
  BlockArrays table{};
  table.table = 1;
  for (int c = 0; c < dimension; ++c) {
    table.lower[c] = -((scene.padding[c] + block_cells - 1) / block_cells);
    table.extent[c] = (scene.cells[c] + scene.padding[c]) / block_cells - table.lower[c] + 1;
    table.table *= table.extent[c];
  }
  return table;
}

/// How many ints the arrays of a body's blocks hold. They are allocated by it, and counted by it before a run begins.
struct BlockRoom {
  int chunks;                ///< in which the blocks of the table are numbered
  std::size_t most;          ///< blocks that the particles may be in
  std::size_t of_particles;  ///< block and order
  std::size_t of_table;      ///< count and next
  std::size_t of_chunks;     ///< chunk and before_chunk
  std::size_t of_list;       ///< begin and cell
  std::size_t state = 2;     ///< in_order and active

  /// `table`: blocks of the grid.
  BlockRoom(int table, std::size_t particles)
      : chunks((table + chunk_of_blocks - 1) / chunk_of_blocks),
        most(std::min(particles, static_cast<std::size_t>(table))),
        of_particles(2 * particles),
        of_table(2 * static_cast<std::size_t>(table)),
        of_chunks(4 * static_cast<std::size_t>(chunks)),
        of_list(4 * most + 1) {}
};

/// The blocks of one body, on the device.
class Blocks {
 public:
  /// `scene` holds cells and padding.
  template <class T>
  Blocks(Device& device, const std::string& body, const Arguments<T>& scene, int dimension, std::size_t particles)
      : table_(table_of_blocks(scene, dimension)),
        room_(table_.table, particles),
        of_particle_(device, "the blocks of " + body, room_.of_particles),
        of_table_(device, "the blocks of " + body, room_.of_table),
        of_chunks_(device, "the blocks of " + body, room_.of_chunks),
        of_list_(device, "the blocks of " + body, room_.of_list),
        state_(device, "the blocks of " + body, room_.state) {
    of_particle_.fill(0xff);  // no particle is in any block yet
    state_.upload({1, 0});
    table_.block = of_particle_.data(), table_.order = of_particle_.data() + particles;
    table_.count = of_table_.data(), table_.next = of_table_.data() + table_.table;
    table_.chunk = of_chunks_.data(), table_.before_chunk = of_chunks_.data() + room_.of_chunks / 2;
    table_.begin = of_list_.data(), table_.cell = of_list_.data() + room_.most + 1;
    table_.in_order = state_.data(), table_.active = state_.data() + 1;
  }

  const BlockArrays& table() const { return table_; }
  /// The chunks in which the blocks of the table are numbered.
  int chunks() const { return room_.chunks; }
  /// The most blocks that the particles may be in.
  int most() const { return static_cast<int>(room_.most); }

 private:
  BlockArrays table_;
  BlockRoom room_;
  DeviceArray<int> of_particle_, of_table_, of_chunks_, of_list_, state_;
};

}  // namespace mpm::device
