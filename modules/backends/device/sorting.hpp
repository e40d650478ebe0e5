#pragma once
// Particles are worked on in blocks of cells. The host sorts their indices: the particles themselves stay where they are.

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "backends/device/device.hpp"

namespace mpm::device {

/// The blocks of one body, on the device.
class Blocks {
 public:
  explicit Blocks(Device& device, const std::string& body)
      : cell_(device, "the blocks of " + body),
        begin_(device, "the blocks of " + body),
        order_(device, "the order of the particles of " + body) {}

  int count() const { return count_; }
  BlockArrays table() const { return {cell_.data(), begin_.data(), order_.data()}; }

  /// Sorts particles by their positions, [component][particle], blocks in order of their cells. A position that is no
  /// number goes to block 0, where the scatter reports it.
  template <class T>
  void sort(const Arguments<T>& scene, const std::vector<T>& position, int dimension) {
    const std::size_t count = position.size() / static_cast<std::size_t>(dimension);
    std::map<std::array<int, 3>, std::vector<int>> blocks;
    for (std::size_t p = 0; p < count; ++p) {
      std::array<int, 3> cell{};
      for (int c = 0; c < dimension; ++c) {
        const T x = (position[static_cast<std::size_t>(c) * count + p] - scene.lower[c]) * scene.inverse_cell_size;
        if (std::abs(x) < T(1e9)) cell[c] = static_cast<int>(std::floor(x / block_cells)) * block_cells;
      }
      blocks[cell].push_back(static_cast<int>(p));
    }
    std::vector<int> cells, begin{0}, order;
    for (const auto& [cell, particles] : blocks) {
      cells.insert(cells.end(), cell.begin(), cell.end());
      order.insert(order.end(), particles.begin(), particles.end());
      begin.push_back(static_cast<int>(order.size()));
    }
    cell_.upload(cells), begin_.upload(begin), order_.upload(order);
    count_ = static_cast<int>(begin.size()) - 1;
  }

 private:
  int count_ = 0;
  DeviceArray<int> cell_, begin_, order_;
};

}  // namespace mpm::device
