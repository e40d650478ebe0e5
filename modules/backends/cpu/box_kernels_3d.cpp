#include "box_kernels.hpp"

namespace mpm::cpu {

template <>
ListKernels<3, double> list_kernels<3, double>() {
  return list_kernels_of<3, double>();
}

}  // namespace mpm::cpu
