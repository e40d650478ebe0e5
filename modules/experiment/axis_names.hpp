#pragma once

namespace mpm {

/// What messages call the axes.
inline constexpr const char* axis_names[] = {"x", "y", "z"};

}  // namespace mpm
