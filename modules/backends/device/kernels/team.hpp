#pragma once
// A team of lanes works on one block. A kernel is a sequence of phases: for_each_lane runs one phase over all lanes and
// ends when all lanes have ended it. On the GPU a lane is a thread and the end a barrier; on the host a lane is one
// turn of a loop. A kernel keeps nothing in local variables from one phase to the next: what must last is in memory.

#include "backends/device/kernels/recording.hpp"
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
  MPM_HD static void lower(unsigned long long* to, unsigned long long value) { atomicMin(to, value); }
  /// Raises a counter by one and returns its value before; which lane gets which depends on their order.
  MPM_HD static int take_number(int* counter) { return atomicAdd(counter, 1); }
  /// Writes what all lanes that write there write.
  template <class T>
  MPM_HD static void put(T* to, T value) {
    *static_cast<volatile T*>(to) = value;
  }
  /// Reads what others may lower, raise or put at the same time.
  template <class T>
  MPM_HD static T look(const T* at) {
    return *static_cast<const volatile T*>(at);
  }

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

// The order in which the host takes the lanes of a team, and the teams: any other number shuffles them by it as a seed.
inline constexpr unsigned order_upwards = 0, order_downwards = 1;

/// The k-th of `count` in an order. A shuffle is a Feistel network over the numbers below the next power of four, whose
/// way is walked on until it is below `count`.
inline int in_order(int k, int count, unsigned order) {
  if (order == order_upwards) return k;
  if (order == order_downwards) return count - 1 - k;
  unsigned half = 1;
  while (half < 15 && (1u << 2 * half) < static_cast<unsigned>(count)) ++half;
  const unsigned mask = (1u << half) - 1;
  unsigned at = static_cast<unsigned>(k);
  do {
    for (unsigned round = 0; round < 4; ++round) {
      const unsigned low = at & mask, high = at >> half;
      const unsigned mixed = (low + order * 0x9e3779b9u + round * 0x85ebca6bu) * 0xc2b2ae35u;
      at = low << half | ((high ^ mixed >> 16) & mask);
    }
  } while (at >= static_cast<unsigned>(count));
  return static_cast<int>(at);
}

class Team {
 public:
  Team(void* shared, int block, int lanes, unsigned order)
      : shared_(shared), block_(block), lanes_(lanes), order_(order) {}
  int block() const { return block_; }
  int lanes() const { return lanes_; }
  template <class T>
  T* shared() const {
    return static_cast<T*>(shared_);
  }
  template <class Phase>
  void for_each_lane(Phase phase) const {
    for (int k = 0; k < lanes_; ++k) {
      const int lane = in_order(k, lanes_, order_);
      begin_lane(lane);
      phase(lane);
    }
    end_phase();
  }
  template <class T>
  static void add(T* to, T value) {
    const SharedAccess noted;
    *to += value;
  }
  template <class T>
  static void lower(T* to, T value) {
    const SharedAccess noted;
    if (value < *to) *to = value;
  }
  static int take_number(int* counter) {
    const SharedAccess noted;
    return (*counter)++;
  }
  template <class T>
  static void put(T* to, T value) {
    const SharedAccess noted;
    *to = value;
  }
  template <class T>
  static T look(const T* at) {
    const SharedAccess noted;
    return *at;
  }

 private:
  void* shared_;
  int block_, lanes_;
  unsigned order_;
};

/// Shared memory starts as NaN, so that what a kernel reads before it has written it shows.
MPM_UNRECORDED inline void forget(unsigned char* shared, int bytes) {
  for (int k = 0; k < bytes; ++k) shared[k] = 0xff;
}

/// Makes the entry on the host: teams run one after another, in an order like the lanes in them.
#define MPM_DEVICE_ENTRY(name, kernel, scalars)                                                                \
  extern "C" void name(const mpm::device::Arguments<Scene::Scalar>* a, int teams, int lanes, unsigned order) { \
    alignas(16) unsigned char shared[sizeof(Scene::Scalar) * (scalars)];                                       \
    for (int k = 0; k < teams; ++k) {                                                                          \
      const int team = mpm::device::in_order(k, teams, order);                                                 \
      mpm::device::forget(shared, static_cast<int>(sizeof shared));                                            \
      mpm::device::begin_team(team, shared, sizeof shared);                                                    \
      mpm::device::kernel(mpm::device::Team(shared, team, lanes, order), *a);                                  \
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
