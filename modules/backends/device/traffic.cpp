#include "backends/device/traffic.hpp"

#include "backends/device/drivers/host_driver.hpp"
#include "backends/device/program.hpp"
#include "simulation/simulation.hpp"

namespace mpm::device {

double StepTraffic::bytes_per_particle_step() const {
  double bytes = 0;
  for (const auto& [kernel, moved] : kernels) bytes += moved.bytes();
  return bytes / steps / static_cast<double>(particles);
}
double StepTraffic::copied_per_particle_step() const {
  return bytes_copied / steps / static_cast<double>(particles);
}
double StepTraffic::launches_per_step() const {
  double launches = 0;
  for (const auto& [kernel, moved] : kernels) launches += static_cast<double>(moved.launches);
  return launches / steps;
}

StepTraffic count_traffic(const Experiment& experiment, int steps) {
  set_host_devices({{"host, recording", 0, 0, true}});
  StepTraffic result;
  result.steps = steps;
  {
    Simulation simulation(experiment, [](const Experiment& e, const Plan& plan, const std::vector<SeededBody>& bodies) {
      return make_device_backend(e, plan, bodies, recording_setup());
    });
    simulation.observe_when([](double, long) { return false; });
    simulation.step();  // what is made once is no part of a step
    recorder_on_host(0).forget_traffic();
    const std::uint64_t before = bytes_copied_on_host();
    for (int step = 0; step < steps; ++step) simulation.step();
    result.bytes_copied = static_cast<double>(bytes_copied_on_host() - before);
    result.particles = simulation.particle_count();
    for (const auto& [entry, moved] : recorder_on_host(0).traffic())
      result.kernels[entry.substr(std::string("mpm_").size())] = moved;
  }
  set_host_devices({HostDevice{}});
  return result;
}

}  // namespace mpm::device
