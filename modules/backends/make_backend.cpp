#include "backends/make_backend.hpp"

#include <algorithm>

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

BackendFactory backend_factory(int threads, bool find_number) {
  return [threads, find_number](const Experiment& experiment, const Plan& plan, std::vector<SeededBody> bodies) {
    if (experiment.backend == "reference") return make_reference_backend(experiment, plan, std::move(bodies));
    const int workers = useful_threads(threads, bodies);  // results do not depend on their number
    return make_cpu_backend(experiment, plan, std::move(bodies), workers, find_number);
  };
}

}  // namespace mpm
