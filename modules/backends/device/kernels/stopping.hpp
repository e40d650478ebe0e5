#pragma once
// A particle that cannot go on stops the run. The phase that finds it runs to its end, and of all that it finds the lowest
// index counts; later phases leave memory as it is, so that the host may look after the step and finds what the phase left.

#include "backends/device/kernels/arguments.hpp"
#include "backends/device/kernels/team.hpp"

namespace mpm::device {

/// What stands in Arguments::stop: the number of the launch that has reported a particle, and that particle's index; both
/// are the largest int where there is none.
enum : int { stop_launch = 0, stop_particle, stop_numbers };

/// Reports a particle that cannot go on.
template <class T>
MPM_HD void report(const Arguments<T>& a, int particle) {
  Team::lower(a.stop + stop_launch, a.launch);
  Team::lower(a.stop + stop_particle, particle);
}

/// Runs a kernel, unless an earlier launch has reported a particle.
template <auto kernel, class T>
MPM_HD void run_unless_stopped(const Team& team, const Arguments<T>& a) {
  if (Team::look(a.stop + stop_launch) < a.launch) return;
  kernel(team, a);
}

/// Makes the entry of a phase.
#define MPM_DEVICE_PHASE(name, kernel, scalars) MPM_DEVICE_ENTRY(name, run_unless_stopped<kernel>, scalars)

}  // namespace mpm::device
