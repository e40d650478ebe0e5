#pragma once
// A particle that cannot go on stops the run. The phase that finds it runs to its end, and of all that it finds the lowest
// index counts; later phases leave memory as it is, so that the host may look after the step and finds what the phase left.

#include "backends/device/kernels/arguments.hpp"
#include "backends/device/kernels/team.hpp"

namespace mpm::device {

/// What stands in Arguments::stop: the number of the launch that has reported a particle above that particle's index; the
/// largest number where there is none. The lowest is that of the first launch, and of its particles the first.
using Stopped = unsigned long long;
inline constexpr Stopped nothing_stopped = ~Stopped(0);

MPM_HD Stopped stopped_at(int launch, int particle) {
  return Stopped(launch) << 32 | Stopped(particle);
}
MPM_HD int launch_of(Stopped stopped) {
  return static_cast<int>(stopped >> 32);
}
MPM_HD int particle_of(Stopped stopped) {
  return static_cast<int>(stopped & 0xffffffffu);
}

/// What the part of a launch that strains adds to the number of the launch (kernels/advance.hpp).
inline constexpr int part_of_strain = 1;

/// Reports a particle that cannot go on. A launch that does what several launches would do has a number for each `part`.
template <class T>
MPM_HD void report(const Arguments<T>& a, int particle, int part = 0) {
  Team::lower(a.stop, stopped_at(a.launch + part, particle));
}

/// Runs a kernel, unless an earlier launch has reported a particle.
template <auto kernel, class T>
MPM_HD void run_unless_stopped(const Team& team, const Arguments<T>& a) {
  const Stopped stopped = Team::look(a.stop);
  if (stopped != nothing_stopped && launch_of(stopped) < a.launch) return;
  kernel(team, a);
}

/// Makes the entry of a phase.
#define MPM_DEVICE_PHASE(name, kernel, scalars) MPM_DEVICE_ENTRY(name, run_unless_stopped<kernel>, scalars)

}  // namespace mpm::device
