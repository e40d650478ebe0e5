#include "box_kernels.hpp"

namespace mpm::cpu {

template <>
ListKernels<2, double> list_kernels<2, double>() {
  return list_kernels_of<2, double>();
}

}  // namespace mpm::cpu
