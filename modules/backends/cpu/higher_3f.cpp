#include "higher_kernels.hpp"

namespace mpm::cpu {

template <>
HigherKernels<3, float> higher_kernels<3, float>(int width, int order) {
  return choose_higher_kernels<3, float>(width, order);
}

}  // namespace mpm::cpu
