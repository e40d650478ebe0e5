#include "box_kernels.hpp"

namespace mpm::cpu {

template <>
ListKernels<3, float> list_kernels<3, float>() {
  return list_kernels_of<3, float>();
}

}  // namespace mpm::cpu
