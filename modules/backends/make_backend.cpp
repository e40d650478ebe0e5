#include "backends/make_backend.hpp"

#include <algorithm>

#include "backends/device/make_device_backend.hpp"
#include "backends/device/program.hpp"
#include "experiment/device_settings.hpp"

namespace mpm {
namespace {

/// Workers wait for one another several times a step: with fewer particles each than this, one more worker costs more
/// than it gives.
constexpr std::size_t particles_a_worker = 2000;

int useful_threads(int wanted, const std::vector<SeededBody>& bodies) {
  std::size_t particles = 0;
  for (const SeededBody& body : bodies) particles += body.count();
  return std::clamp(static_cast<int>(particles / particles_a_worker), 1, wanted);
}

}  // namespace

BackendFactory backend_factory(int threads, bool find_number, const std::string& device) {
  return
      [threads, find_number, device](const Experiment& experiment, const Plan& plan, std::vector<SeededBody> bodies) {
        if (experiment.backend == "reference") return make_reference_backend(experiment, plan, std::move(bodies));
        if (experiment.backend == "cuda") {
          device::DeviceSetup setup = device::setup_for(device);
          setup.deterministic = sums_deterministically(experiment);
          return device::make_device_backend(experiment, plan, bodies, setup);
        }
        const int workers = useful_threads(threads, bodies);  // results do not depend on their number
        return make_cpu_backend(experiment, plan, std::move(bodies), workers, find_number);
      };
}

BackendFactory unstepped_backend_factory() {
  return [](const Experiment& experiment, const Plan& plan, std::vector<SeededBody> bodies) {
    if (experiment.backend == "cpu") return make_cpu_backend(experiment, plan, std::move(bodies), 1);
    return make_reference_backend(experiment, plan, std::move(bodies));
  };
}

}  // namespace mpm
