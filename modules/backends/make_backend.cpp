#include "backends/make_backend.hpp"

namespace mpm {

BackendFactory backend_factory(int threads) {
  return [threads](const Experiment& experiment, const Plan& plan, std::vector<SeededBody> bodies) {
    return experiment.backend == "reference" ? make_reference_backend(experiment, plan, std::move(bodies))
                                             : make_cpu_backend(experiment, plan, std::move(bodies), threads);
  };
}

}  // namespace mpm
