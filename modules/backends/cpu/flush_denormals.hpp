#pragma once
// Numbers below the smallest normal one (1e-38 in float) count as zero while particles and nodes are worked on: a body
// at rest makes many, and each costs the processor a hundred cycles.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace mpm::cpu {

/// Applies to the thread that makes it, and ends when it is destroyed.
class FlushDenormals {
 public:
#if defined(__SSE2__)
  FlushDenormals() : before_(_mm_getcsr()) {
    _mm_setcsr(before_ | 0x8040);
  }  // results and operands below it count as zero
  ~FlushDenormals() {
    _mm_setcsr(before_);
  }

 private:
  unsigned before_;
#else
  FlushDenormals() {}  // other processors handle such numbers at full speed
#endif
 public:
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
};

}  // namespace mpm::cpu
