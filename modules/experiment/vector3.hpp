#pragma once
#include <array>

namespace mpm {
using Vector3 = std::array<double, 3>;  ///< unused components are zero in 2-D
}  // namespace mpm
