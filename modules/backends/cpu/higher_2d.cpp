#include "higher_kernels.hpp"

namespace mpm::cpu {

template <>
HigherKernels<2, double> higher_kernels<2, double>(int width, int order) {
  return choose_higher_kernels<2, double>(width, order);
}

}  // namespace mpm::cpu
