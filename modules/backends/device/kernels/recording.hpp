#pragma once
// A checking build of a composition tells the host driver of every access to memory, so that it finds two lanes on one
// address (drivers/race_recorder.hpp). The compiler writes the calls: -fsanitize=thread puts one before each load and
// store, and this header stands in for the library that would take them. Kernels know nothing of it.

namespace mpm::device {

/// What the driver is told; it fills the table when it loads the program.
struct AccessRecorder {
  void (*begin_team)(int team, const void* shared, unsigned long bytes);
  void (*begin_lane)(int lane);
  void (*end_phase)();
  void (*access)(const void* at, unsigned long bytes, bool writes, bool adds);
};

}  // namespace mpm::device

#if defined(MPM_RECORD)

/// Null until the driver has set it.
extern "C" __attribute__((visibility("default"))) mpm::device::AccessRecorder* mpm_access_recorder;
mpm::device::AccessRecorder* mpm_access_recorder = nullptr;

namespace mpm::device {

inline bool accesses_add = false;  ///< the accesses of now are those that Team lets several lanes make at once

/// Marks accesses that several lanes may make at once, as long as it lives. The compiler must not move them out of it.
struct SharedAccess {
  SharedAccess() {
    accesses_add = true;
    asm volatile("" ::: "memory");
  }
  ~SharedAccess() {
    asm volatile("" ::: "memory");
    accesses_add = false;
  }
};
inline void begin_team(int team, const void* shared, unsigned long bytes) {
  mpm_access_recorder->begin_team(team, shared, bytes);
}
inline void begin_lane(int lane) {
  mpm_access_recorder->begin_lane(lane);
}
inline void end_phase() {
  mpm_access_recorder->end_phase();
}

}  // namespace mpm::device

/// Stands before a function whose accesses are not told.
#define MPM_UNRECORDED __attribute__((no_sanitize("thread"), noinline))
#define MPM_ACCESS(name, bytes, writes)                                        \
  extern "C" MPM_UNRECORDED void name(void* at) {                              \
    mpm_access_recorder->access(at, bytes, writes, mpm::device::accesses_add); \
  }
#define MPM_ACCESSES(prefix, bytes)                      \
  MPM_ACCESS(__tsan_##prefix##read##bytes, bytes, false) \
  MPM_ACCESS(__tsan_##prefix##write##bytes, bytes, true)
MPM_ACCESSES(, 1)
MPM_ACCESSES(, 2)
MPM_ACCESSES(, 4)
MPM_ACCESSES(, 8)
MPM_ACCESSES(, 16)
MPM_ACCESSES(unaligned_, 2)
MPM_ACCESSES(unaligned_, 4)
MPM_ACCESSES(unaligned_, 8)
MPM_ACCESSES(unaligned_, 16)
extern "C" {
MPM_UNRECORDED void __tsan_read_range(void* at, unsigned long bytes) {
  mpm_access_recorder->access(at, bytes, false, mpm::device::accesses_add);
}
MPM_UNRECORDED void __tsan_write_range(void* at, unsigned long bytes) {
  mpm_access_recorder->access(at, bytes, true, mpm::device::accesses_add);
}
void __tsan_func_entry(void*) {}
void __tsan_func_exit() {}
void __tsan_init() {}
}
#undef MPM_ACCESSES
#undef MPM_ACCESS

#elif !defined(__CUDACC__)

#define MPM_UNRECORDED
namespace mpm::device {

struct SharedAccess {
  SharedAccess() {}
};
inline void begin_team(int, const void*, unsigned long) {}
inline void begin_lane(int) {}
inline void end_phase() {}

}  // namespace mpm::device

#endif
