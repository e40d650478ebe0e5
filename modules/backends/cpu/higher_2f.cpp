#include "higher_kernels.hpp"

namespace mpm::cpu {

template <>
HigherKernels<2, float> higher_kernels<2, float>(int width, int order) {
  return choose_higher_kernels<2, float>(width, order);
}

}  // namespace mpm::cpu
