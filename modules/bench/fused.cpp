#include "bench/fused.hpp"

#include <stdexcept>
#include <utility>

#include "backends/libraries/backend_library.hpp"

namespace mpm::bench {

std::unique_ptr<Backend> make_fused_backend(const Experiment& experiment, const Plan& plan,
                                            std::vector<SeededBody> seeds, int threads) {
  bool known = experiment.shape.plugin->id() == "bspline_quadratic" && experiment.transfer.plugin->id() == "mls" &&
               !experiment.filter;
  for (const auto& material : experiment.materials) known = known && material.component.plugin->id() == "neo_hookean";
  if (!known) throw std::invalid_argument("compiled in are only bspline_quadratic, mls and neo_hookean");
  return backend_library("cpu_fused")({experiment, plan, std::move(seeds), threads});
}

}  // namespace mpm::bench
