#include "box_kernels.hpp"

namespace mpm::cpu {

template <>
ListKernels<2, float> list_kernels<2, float>() {
  return list_kernels_of<2, float>();
}

}  // namespace mpm::cpu
