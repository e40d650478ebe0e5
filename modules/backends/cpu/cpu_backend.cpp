#include "backends/cpu/cpu_backend.hpp"

namespace mpm {
namespace cpu {
extern template class GridStep<2, float>;
extern template class GridStep<2, double>;
extern template class GridStep<3, float>;
extern template class GridStep<3, double>;
extern template class ParticleStep<2, float>;
extern template class ParticleStep<2, double>;
extern template class ParticleStep<3, float>;
extern template class ParticleStep<3, double>;
}  // namespace cpu

std::unique_ptr<Backend> make_cpu_backend(const Experiment& experiment, const Plan& plan, std::vector<SeededBody> seeds,
                                          int threads, bool find_number) {
  const bool single = experiment.precision == Precision::single;
  if (experiment.dimension == 2) {
    if (single)
      return std::make_unique<cpu::CpuBackend<2, float>>(experiment, plan, std::move(seeds), threads, find_number);
    return std::make_unique<cpu::CpuBackend<2, double>>(experiment, plan, std::move(seeds), threads, find_number);
  }
  if (single)
    return std::make_unique<cpu::CpuBackend<3, float>>(experiment, plan, std::move(seeds), threads, find_number);
  return std::make_unique<cpu::CpuBackend<3, double>>(experiment, plan, std::move(seeds), threads, find_number);
}

}  // namespace mpm
