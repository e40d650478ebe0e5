// The cpu backend with one combination compiled in (bench/fused.hpp).
#include <utility>

#include "backends/cpu/cpu_backend.hpp"
#include "backends/cpu/particles/particle_dilation.hpp"
#include "backends/cpu/particles/particle_gather.hpp"
#include "backends/cpu/particles/particle_heat.hpp"
#include "backends/cpu/particles/particle_scatter.hpp"
#include "backends/cpu/particles/particle_viscosity.hpp"
#include "backends/libraries/backend_library.hpp"
#include "materials/neo_hookean/neo_hookean.hpp"
#include "plugin/sdk.hpp"
#include "shapes/bspline_quadratic/bspline_quadratic.hpp"
#include "transfers/mls/mls.hpp"

namespace mpm::cpu {
extern template class GridStep<2, float>;
extern template class GridStep<2, double>;
extern template class GridStep<3, float>;
extern template class GridStep<3, double>;
}  // namespace mpm::cpu

namespace mpm::bench {
namespace {

template <int D, class T>
struct FusedComponents {
  using S = Lanes<T>;
  static void evaluate_shape(const cpu::Scene<D, T>& scene, const mpm_shape_batch& batch) {
    sdk::shape_batch<BsplineQuadratic, S>(scene.shape_parameters, &batch);
  }
  static void scatter(const cpu::Scene<D, T>& scene, const mpm_scatter_batch& batch) {
    sdk::scatter_batch<Mls, D, S>(scene.transfer_parameters, &batch);
  }
  static void gather(const cpu::Scene<D, T>& scene, const mpm_gather_batch& batch) {
    sdk::gather_batch<Mls, D, S>(scene.transfer_parameters, &batch);
  }
  static std::int32_t update_material(const cpu::Body<D, T>& body, const mpm_material_batch& batch) {
    return sdk::material_batch<NeoHookean, D, S>(body.material->parameters.data(), &batch);
  }
};

template <int D, class T>
std::unique_ptr<Backend> make(BackendRequest request) {
  return std::make_unique<cpu::CpuBackend<D, T, FusedComponents<D, T>>>(request.experiment, request.plan,
                                                                        std::move(request.bodies), request.threads);
}

}  // namespace

}  // namespace mpm::bench

namespace mpm::cpu {

std::unique_ptr<Backend> make_fused(BackendRequest request) {
  const bool single = request.experiment.precision == Precision::single;
  if (request.experiment.dimension == 2)
    return single ? bench::make<2, float>(std::move(request)) : bench::make<2, double>(std::move(request));
  return single ? bench::make<3, float>(std::move(request)) : bench::make<3, double>(std::move(request));
}

}  // namespace mpm::cpu
