#pragma once
// Counters in memory that lanes of all teams raise, each of them taking a number that no other takes.

#include "kernel/config.hpp"

namespace mpm::device {

/// Raises a counter by one and returns its value before. Which lane takes which number depends on their order.
#if defined(__CUDACC__)
__device__ __forceinline__ int take_number(int* counter) {
  return atomicAdd(counter, 1);
}
#else
inline int take_number(int* counter) {
  return (*counter)++;
}
#endif

}  // namespace mpm::device
