#pragma once
// What differs between the compilers that read the kernel headers: g++, nvcc and NVRTC.

#if defined(__CUDACC__)
#define MPM_HD __host__ __device__ __forceinline__
#elif defined(MPM_DEVICE_PASS)
#define MPM_HD inline
#else
#define MPM_HD inline __attribute__((always_inline))
#endif

// MPM_HOST is 1 where host tables and system headers may be seen.
#if defined(MPM_DEVICE_PASS) || defined(__CUDACC_RTC__)
#define MPM_HOST 0
#else
#define MPM_HOST 1
#endif

// MPM_UNROLL stands before a loop of few steps, whose number is constant, and writes them all out.
#if defined(__CUDACC__)
#define MPM_UNROLL _Pragma("unroll")
#elif defined(MPM_DEVICE_PASS) || defined(__clang__)
#define MPM_UNROLL
#else
#define MPM_UNROLL _Pragma("GCC unroll 64")
#endif
