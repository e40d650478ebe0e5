// The makers of backends, whose libraries are linked in or loaded.
#include <string>
#include <utility>

#include "backends/device/make_device_backend.hpp"
#include "backends/libraries/backend_library.hpp"

namespace mpm {
namespace {

std::string library_of_cpu(const Experiment& experiment) {
  return std::string(experiment.dimension == 2 ? "cpu_2" : "cpu_3") +
         (experiment.precision == Precision::single ? "_float" : "_double");
}

}  // namespace

void load_backend_library(const Experiment& experiment) {
  const bool device = experiment.backend == "cuda";
  if (device) backend_library("device");
  backend_library(experiment.backend == "cpu" ? library_of_cpu(experiment) : "reference");  // shows a device's start
}

std::unique_ptr<Backend> make_reference_backend(const Experiment& experiment, const Plan& plan,
                                                std::vector<SeededBody> seeds) {
  return backend_library("reference")({experiment, plan, std::move(seeds)});
}

std::unique_ptr<Backend> make_cpu_backend(const Experiment& experiment, const Plan& plan, std::vector<SeededBody> seeds,
                                          int threads, bool find_number) {
  return backend_library(library_of_cpu(experiment))({experiment, plan, std::move(seeds), threads, find_number});
}

std::unique_ptr<Backend> device::make_device_backend(const Experiment& experiment, const Plan& plan,
                                                     const std::vector<SeededBody>& seeded, const DeviceSetup& setup) {
  return backend_library("device")({experiment, plan, seeded, 1, false, &setup});
}

}  // namespace mpm
