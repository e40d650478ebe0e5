#pragma once
// The rows of a functor's tables of parameters and state. Functors include this inside #if MPM_HOST: tables stand
// beside the method, so that one file holds both, and compilers of device code never see them.

#include <cstddef>
#include <limits>

#include "plugin/extensions.h"

namespace mpm {
inline constexpr double unbounded = std::numeric_limits<double>::infinity();
inline constexpr double required = std::numeric_limits<double>::quiet_NaN();
/// The bound of a clamp that cannot act.
inline constexpr double no_bound = std::numeric_limits<double>::quiet_NaN();
}  // namespace mpm

/// Rows of a parameter table; `member` names both the key in the file and the double in Parameters.
#define MPM_NUMBER_PARAMETER(member, unit, default_value, minimum, maximum, flags, doc)             \
  {                                                                                                 \
#member, unit, doc, "", MPM_NUMBER,                                                             \
        static_cast < uint32_t>((flags) | ((default_value) == (default_value) ? 0 : MPM_REQUIRED)), \
        offsetof(Parameters, member), 0, default_value, minimum, maximum                            \
  }
#define MPM_INTEGER_PARAMETER(member, default_value, minimum, maximum, doc)                   \
  {                                                                                           \
#member, "", doc, "", MPM_INTEGER, (default_value) == (default_value) ? 0 : MPM_REQUIRED, \
        offsetof(Parameters, member), 0, default_value, minimum, maximum                      \
  }
#define MPM_BOOLEAN_PARAMETER(member, default_value, doc) \
  { #member, "", doc, "", MPM_BOOLEAN, 0, offsetof(Parameters, member), 0, default_value, 0, 1 }
#define MPM_CHOICE_PARAMETER(member, choices, default_index, doc) \
  { #member, "", doc, choices, MPM_CHOICE, 0, offsetof(Parameters, member), 0, default_index, 0, 0 }
