#pragma once
// What the machine can do at best, measured: fused multiply-adds and bytes a second.

#include <cstddef>

namespace mpm::bench {

/// Name of the widest instruction set that the build uses, and its lanes of float and double.
const char* instruction_set();
int lanes_of_float();
int lanes_of_double();

/// GFLOP/s of independent chains of multiply-adds in the widest vectors of the build (2 a multiply-add), all threads
/// together. The best of `windows` windows of 2 ms, short so that some are undisturbed on a busy machine too.
double peak_gflops(bool single, int threads, int windows);

struct MemoryBandwidth {
  double triad = 0, update = 0, read = 0;  ///< GB/s: a = b + s c (3 streams), a = s a (2 streams), sum of a
};
/// Measures on arrays of `bytes` each, far beyond the caches where they are the machine's alone, passed through
/// `repeats` times; the best piece of 16 MB counts. Bytes are those that the program names: a store's read of its line
/// is not counted.
MemoryBandwidth memory_bandwidth(int threads, std::size_t bytes, int repeats);

/// Nanoseconds that a line of the cache takes from one thread to another and is seen there: two threads hand it to and
/// fro for about `seconds`. They are some 50 where the processors share a cache, 200 where they do not; on virtual
/// machines this changes.
double nanoseconds_between_threads(double seconds);

}  // namespace mpm::bench
