#include "higher_kernels.hpp"

namespace mpm::cpu {

template <>
HigherKernels<3, double> higher_kernels<3, double>(int width, int order) {
  return choose_higher_kernels<3, double>(width, order);
}

}  // namespace mpm::cpu
