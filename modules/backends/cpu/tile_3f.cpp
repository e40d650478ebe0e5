#include <stdexcept>

#include "tile_nodes.hpp"

namespace mpm::cpu {

template <>
TileKernels<3, float> tile_kernels<3, float>(int width) {
  if (width == 2) return tile_kernels_of_width<3, float, 2>();
  if (width == 3) return tile_kernels_of_width<3, float, 3>();
  if (width == 4) return tile_kernels_of_width<3, float, 4>();
  throw std::invalid_argument("the cpu backend takes shapes of 2, 3 or 4 nodes an axis");
}

template <>
TileKernels<3, float> tile_kernels_of_lists<3, float>() {
  return tiles_of_lists<3, float>();
}

}  // namespace mpm::cpu
