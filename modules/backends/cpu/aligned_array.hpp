#pragma once
// Storage for particles and grid channels is aligned, never initialised twice, and in huge pages when it is large.

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

namespace mpm::cpu {

/// The size of a page, bytes. What different threads write lies in different pages: a processor fetches lines ahead of
/// those that it reads, up to the end of their page, and takes them from the cache of another.
inline constexpr std::size_t page = 4096;

template <class T>
class AlignedArray {
 public:
  /// Makes room for at least `count` elements, which are zero after growth; growth discards the contents.
  void require(std::size_t count) {
    if (count <= size_) return;
    constexpr std::size_t huge_page = std::size_t{1} << 21;
    const std::size_t bytes = count * sizeof(T), alignment = bytes < huge_page ? page : huge_page;
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    data_.reset();
    size_ = 0;
    data_.reset(static_cast<T*>(std::aligned_alloc(alignment, rounded)));
    if (!data_) throw std::bad_alloc();
    if (alignment == huge_page) madvise(data_.get(), rounded, MADV_HUGEPAGE);
    std::memset(static_cast<void*>(data_.get()), 0, rounded);
    size_ = rounded / sizeof(T);
  }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }
  std::size_t bytes() const { return size_ * sizeof(T); }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::unique_ptr<T, Free> data_;
  std::size_t size_ = 0;
};

}  // namespace mpm::cpu
