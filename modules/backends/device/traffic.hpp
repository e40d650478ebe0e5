#pragma once
// What a step moves, counted: the host driver records every access of every kernel, and counts what it copies.

#include <map>
#include <string>

#include "backends/device/drivers/race_recorder.hpp"
#include "backends/device/make_device_backend.hpp"

namespace mpm::device {

/// Counts of one step on average.
struct StepTraffic {
  std::map<std::string, Traffic> kernels;  ///< by phase, "scatter"; of all steps counted
  int steps = 0;
  std::size_t particles = 0;
  double bytes_copied = 0;  ///< between host and device, of all steps counted

  double bytes_per_particle_step() const;
  double copied_per_particle_step() const;
  double launches_per_step() const;
};

/// Runs some steps of an experiment of backend "cuda" on the host driver, and counts those after the first. It takes a
/// microsecond an access: give it a scene of few particles. Nobody else may use the host driver. Throws CompilerError.
StepTraffic count_traffic(const Experiment& experiment, int steps);

}  // namespace mpm::device
