#pragma once
// Blocks of cells, 4^3 in 3-D and 8^2 in 2-D, are found by hash so that an empty domain costs no memory.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plugin/abi.h"

namespace mpm::cpu {

/// The number of particles in a chunk: half as many in double, so that a step's data stay in the first-level cache.
template <class T>
inline constexpr int chunk_size = sizeof(T) == 4 ? MPM_BATCH : MPM_BATCH / 2;
inline constexpr int block_nodes = 64;  ///< nodes (and cells) in a block, in both dimensions

template <int D>
inline constexpr int block_bits = D == 3 ? 2 : 3;
template <int D>
inline constexpr int block_side = 1 << block_bits<D>;
template <int D>
inline constexpr int neighbour_count = D == 3 ? 27 : 9;

/// The position of a block in the lattice of blocks; its first node is block_side times that. Unused axes are zero.
using BlockCoordinates = std::array<int, 3>;

/// The number of a node within its block, the last axis fastest.
template <int D>
constexpr int node_in_block(const std::array<int, 3>& node) {
  constexpr int mask = block_side<D> - 1;
  int index = 0;
  for (int axis = 0; axis < D; ++axis) index = (index << block_bits<D>) | (node[axis] & mask);
  return index;
}

/// The lattice position of a node of a block.
template <int D>
constexpr std::array<int, 3> node_at(const BlockCoordinates& block, int local) {
  std::array<int, 3> node{};
  for (int axis = D - 1; axis >= 0; --axis, local >>= block_bits<D>)
    node[axis] = block[axis] * block_side<D> + (local & (block_side<D> - 1));
  return node;
}

/// An open-addressing map from block coordinates to a number.
class BlockTable {
 public:
  /// Has room for `expected` blocks before it must grow.
  explicit BlockTable(std::size_t expected = 32)
      : keys_(std::bit_ceil(2 * std::max<std::size_t>(expected, 32)), empty), values_(keys_.size(), -1) {}
  void clear() {  // its size stays, as it is filled again with about as many
    std::fill(keys_.begin(), keys_.end(), empty);
    std::fill(values_.begin(), values_.end(), -1);
    count_ = 0;
  }
  /// The number of a block; -1 when it is absent.
  int find(const BlockCoordinates& at) const { return values_[position(key(at))]; }
  /// The number of a block, which becomes `next` when it is new.
  int insert(const BlockCoordinates& at, int next) {
    const std::size_t i = position(key(at));
    if (keys_[i] != empty) return values_[i];
    keys_[i] = key(at);
    values_[i] = next;
    if (2 * ++count_ > keys_.size()) grow();
    return next;
  }

 private:
  static constexpr std::uint64_t empty = ~std::uint64_t{0};
  static std::uint64_t key(const BlockCoordinates& at) {
    constexpr int bias = 1 << 20;
    std::uint64_t k = 0;
    for (int axis = 0; axis < 3; ++axis) k = (k << 21) | (static_cast<std::uint64_t>(at[axis] + bias) & 0x1fffff);
    return k;
  }
  std::size_t position(std::uint64_t k) const {
    std::size_t i = (k * 0x9e3779b97f4a7c15ull) >> 20 & (keys_.size() - 1);
    while (keys_[i] != empty && keys_[i] != k) i = (i + 1) & (keys_.size() - 1);
    return i;
  }
  void grow() {
    std::vector<std::uint64_t> keys(2 * keys_.size(), empty);
    std::vector<int> values(2 * values_.size(), -1);
    keys.swap(keys_);
    values.swap(values_);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i] == empty) continue;
      const std::size_t j = position(keys[i]);
      keys_[j] = keys[i];
      values_[j] = values[i];
    }
  }
  std::vector<std::uint64_t> keys_;
  std::vector<int> values_;
  std::size_t count_ = 0;
};

}  // namespace mpm::cpu
