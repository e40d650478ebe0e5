#pragma once
// A weld: both fields take their common velocity at every node they share, as a single field would.

#include "kernel/sliding.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Stick {
  struct Parameters {};

  template <int D, class S>
  MPM_HD static void apply(const Parameters&, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const S reduced_mass = reduced_mass_of(pair.mass_a, pair.mass_b);
    for (int i = 0; i < D; ++i)
      result.impulse[i] = reduced_mass * (pair.momentum_b[i] / pair.mass_b - pair.momentum_a[i] / pair.mass_a);
    result.dissipated = S(real<S>(0));
    result.status = S(real<S>(1));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_BYPASSES_DETECTION;
#endif
};

}  // namespace mpm
