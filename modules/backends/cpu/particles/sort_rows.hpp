#pragma once
// Particles on their way to another block take one row each, which holds all that travels with them.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "backends/cpu/particles/particles.hpp"

namespace mpm::cpu {

/// The values that a row ends with.
struct RowTail {
  std::int32_t id;
  std::uint32_t cell, slot;
};

/// A row holds position, what lies in a chunk after the components left behind, and tail, in whole lines of the cache.
template <int D, class T>
class RowFormat {
  static constexpr int line = 64;  ///< bytes of a line of the cache

 public:
  /// Unless `with_motion`, velocities and the transfer's state stay behind.
  RowFormat(const Particles<D, T>& particles, bool with_motion)
      : particles_(particles),
        left_behind_(with_motion ? 0 : particles.motion_components),
        values_(particles.components - left_behind_),
        bytes_((values_ * sizeof(T) + sizeof(RowTail) + line - 1) / line * line) {}

  std::size_t bytes() const { return bytes_; }
  /// The number of components of a chunk that stay behind, from the velocity on.
  int left_behind() const { return left_behind_; }

  /// Writes a row; `shift` is in cells from the new block to the old one. A neighbour's rows are written in sequence.
  void write(std::byte* row, std::uint32_t chunk, int lane, std::uint32_t cell, const int* shift) const {
    __builtin_prefetch(row + bytes_, 1, 2);
    const T* const from = particles_.chunk(chunk) + lane;
    T* const values = reinterpret_cast<T*>(row);
    for (int a = 0; a < D; ++a) values[a] = from[a * chunk_size<T>] + static_cast<T>(shift[a]);
    const T* const others = from + left_behind_ * chunk_size<T>;
    for (int c = D; c < values_; ++c) values[c] = others[c * chunk_size<T>];
    const RowTail tail{particles_.ids(chunk)[lane], cell, chunk * chunk_size<T> + lane};
    std::memcpy(row + values_ * sizeof(T), &tail, sizeof tail);
  }
  RowTail tail(const std::byte* row) const {
    RowTail tail;
    std::memcpy(&tail, row + values_ * sizeof(T), sizeof tail);
    return tail;
  }
  void read(const std::byte* row, std::byte* chunk, std::uint32_t lane) const {
    const T* const values = reinterpret_cast<const T*>(row);
    T* const to = particles_.values_at(chunk) + lane;
    for (int a = 0; a < D; ++a) to[a * chunk_size<T>] = values[a];
    T* const others = to + left_behind_ * chunk_size<T>;
    for (int c = D; c < values_; ++c) others[c * chunk_size<T>] = values[c];
    particles_.ids_at(chunk)[lane] = tail(row).id;
  }

  /// Brings what travels of a chunk into the cache, a share with each of some particles before: all at once would fill
  /// the queue of misses and stop the work.
  class Fetching {
   public:
    Fetching() = default;
    Fetching(const RowFormat& format, std::uint32_t chunk, int particles)
        : from_(format.particles_.places[chunk]),
          gap_(format.left_behind_ * component),
          lines_((static_cast<int>(format.particles_.chunk_bytes()) - gap_) / line),
          share_(particles > 0 ? (lines_ + particles - 1) / particles : 0) {}
    void go_on() {
      for (const int end = std::min(next_ + share_, lines_); next_ < end; ++next_)
        __builtin_prefetch(from_ + next_ * line + (next_ < lines_of_positions ? 0 : gap_), 1, 3);
    }

   private:
    static constexpr int component = chunk_size<T> * sizeof(T), lines_of_positions = D * component / line;
    const std::byte* from_ = nullptr;
    int gap_ = 0, lines_ = 0, share_ = 0, next_ = 0;
  };

 private:
  const Particles<D, T>& particles_;
  int left_behind_, values_;
  std::size_t bytes_;
};

}  // namespace mpm::cpu
