#include <stdexcept>

#include "tile_nodes.hpp"

namespace mpm::cpu {

template <>
TileKernels<2, double> tile_kernels<2, double>(int width) {
  if (width == 2) return tile_kernels_of_width<2, double, 2>();
  if (width == 3) return tile_kernels_of_width<2, double, 3>();
  if (width == 4) return tile_kernels_of_width<2, double, 4>();
  throw std::invalid_argument("the cpu backend takes shapes of 2, 3 or 4 nodes an axis");
}

template <>
TileKernels<2, double> tile_kernels_of_lists<2, double>() {
  return tiles_of_lists<2, double>();
}

}  // namespace mpm::cpu
