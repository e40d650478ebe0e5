#pragma once
// Storage of particle chunks is given out and taken back one by one: a sort then needs no second copy of the particles.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "backends/cpu/aligned_array.hpp"

namespace mpm::cpu {

class ChunkPool {
 public:
  /// Sets the size of every chunk, a multiple of 64, before the first is taken.
  void set_chunk_bytes(std::size_t bytes) { chunk_bytes_ = bytes; }
  std::size_t unused() const { return unused_.size(); }

  /// Makes sure that at least `count` chunks can be taken before storage must grow.
  void reserve(std::size_t count) {
    if (count > unused_.size()) grow(count - unused_.size());
  }
  std::byte* take() {
    if (unused_.empty()) grow(1);
    std::byte* const chunk = unused_.back();
    unused_.pop_back();
    return chunk;
  }
  /// Takes a chunk back; this does not allocate.
  void give(std::byte* chunk) { unused_.push_back(chunk); }

  std::size_t bytes() const {
    std::size_t total = 0;
    for (const auto& segment : segments_) total += segment.bytes();
    return total;
  }

 private:
  /// Grows by at least a 64th of what there is, so that growing chunk by chunk stays cheap and wastes little.
  void grow(std::size_t count) {
    const std::size_t chunks = std::max({count, all_ / 64, std::size_t{8}});
    AlignedArray<std::byte>& segment = segments_.emplace_back();
    segment.require(chunks * chunk_bytes_);
    const std::size_t made = segment.bytes() / chunk_bytes_;
    all_ += made;
    unused_.reserve(all_);
    for (std::size_t i = made; i-- > 0;) unused_.push_back(segment.data() + i * chunk_bytes_);
  }

  std::size_t chunk_bytes_ = 0, all_ = 0;
  std::vector<AlignedArray<std::byte>> segments_;
  std::vector<std::byte*> unused_;
};

}  // namespace mpm::cpu
