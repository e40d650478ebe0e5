#pragma once
// The cpu backend with one combination compiled in: what the plugin boundary costs is measured against it.

#include <memory>

#include "simulation/backend.hpp"

namespace mpm::bench {

/// Makes a backend of the same kernels and the same functors as with plugins (bspline_quadratic, mls, neo_hookean),
/// without their tables. Throws std::invalid_argument for another combination.
std::unique_ptr<Backend> make_fused_backend(const Experiment& experiment, const Plan& plan,
                                            std::vector<SeededBody> seeds, int threads);

}  // namespace mpm::bench
