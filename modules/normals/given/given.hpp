#pragma once
// A normal that the experiment gives, the same at every node.

#include "kernel/direction.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Given {
  struct Parameters {
    double x, y, z;  ///< the direction, of any length above 0
  };

  template <int D, class S>
  MPM_HD static void find(const Parameters& p, const NormalPair<D, S>&, NormalResult<D, S>& result) {
    result.normal[0] = S(real<S>(p.x)), result.normal[1] = S(real<S>(p.y));
    if constexpr (D == 3) result.normal[2] = S(real<S>(p.z));
    result.found = make_unit(result.normal);
  }

#if MPM_HOST
  static constexpr unsigned traits = 0;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(x, "", required, -1e6, 1e6, 0, "component of the direction, which may have any length"),
      MPM_NUMBER_PARAMETER(y, "", required, -1e6, 1e6, 0, "component of the direction"),
      MPM_NUMBER_PARAMETER(z, "", 0.0, -1e6, 1e6, 0, "component of the direction, in 3-D"),
  };
#endif
};

}  // namespace mpm
