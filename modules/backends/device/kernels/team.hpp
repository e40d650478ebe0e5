#pragma once
// A team of lanes works on one block. A kernel is a sequence of phases: for_each_lane runs one phase over all lanes and
// ends when all lanes have ended it. On the GPU a lane is a thread and the end a barrier; on the host a lane is one
// turn of a loop. A kernel keeps nothing in local variables from one phase to the next: what must last is in memory.

#include "kernel/config.hpp"

namespace mpm::device {

#if defined(__CUDACC__)

class Team {
 public:
  __device__ explicit Team(void* shared) : shared_(shared) {}
  MPM_HD int block() const { return static_cast<int>(blockIdx.x); }
  MPM_HD int lanes() const { return static_cast<int>(blockDim.x); }
  template <class T>
  MPM_HD T* shared() const {
    return static_cast<T*>(shared_);
  }
  template <class Phase>
  MPM_HD void for_each_lane(Phase phase) const {
    phase(static_cast<int>(threadIdx.x));
    __syncthreads();
  }
  /// Lets several lanes or teams add to one place, in any order.
  template <class T>
  MPM_HD static void add(T* to, T value) {
    atomicAdd(to, value);
  }
  MPM_HD static void lower(int* to, int value) { atomicMin(to, value); }
  /// Raises a counter by one and returns its value before; which lane gets which depends on their order.
  MPM_HD static int take_number(int* counter) { return atomicAdd(counter, 1); }

 private:
  void* shared_;
};

/// Makes the extern "C" entry `name` that runs `kernel` with room for `scalars` values in shared memory.
#define MPM_DEVICE_ENTRY(name, kernel, scalars)                                     \
  extern "C" __global__ void name(const mpm::device::Arguments<Scene::Scalar> a) {  \
    __shared__ alignas(16) unsigned char shared[sizeof(Scene::Scalar) * (scalars)]; \
    mpm::device::kernel(mpm::device::Team(shared), a);                              \
  }

#else

class Team {
 public:
  Team(void* shared, int block, int lanes, bool backwards)
      : shared_(shared), block_(block), lanes_(lanes), backwards_(backwards) {}
  int block() const { return block_; }
  int lanes() const { return lanes_; }
  template <class T>
  T* shared() const {
    return static_cast<T*>(shared_);
  }
  template <class Phase>
  void for_each_lane(Phase phase) const {
    for (int k = 0; k < lanes_; ++k) phase(backwards_ ? lanes_ - 1 - k : k);
  }
  template <class T>
  static void add(T* to, T value) {
    *to += value;
  }
  static void lower(int* to, int value) {
    if (value < *to) *to = value;
  }
  static int take_number(int* counter) { return (*counter)++; }

 private:
  void* shared_;
  int block_, lanes_;
  bool backwards_;
};

/// Makes the entry on the host: teams run one after another, upwards or downwards like the lanes in them. Shared memory
/// starts as NaN, so that what a kernel reads before it has written it shows.
#define MPM_DEVICE_ENTRY(name, kernel, scalars)                                                                \
  extern "C" void name(const mpm::device::Arguments<Scene::Scalar>* a, int teams, int lanes, bool backwards) { \
    alignas(16) unsigned char shared[sizeof(Scene::Scalar) * (scalars)];                                       \
    for (int k = 0; k < teams; ++k) {                                                                          \
      for (unsigned char& byte : shared) byte = 0xff;                                                          \
      mpm::device::kernel(mpm::device::Team(shared, backwards ? teams - 1 - k : k, lanes, backwards), *a);     \
    }                                                                                                          \
  }

#endif

/// Runs one phase over the indices 0 .. count - 1, one a lane of all teams.
template <class Body>
MPM_HD void for_each_index(const Team& team, int count, Body body) {
  team.for_each_lane([&](int lane) {
    const int index = team.block() * team.lanes() + lane;
    if (index < count) body(index);
  });
}

}  // namespace mpm::device
