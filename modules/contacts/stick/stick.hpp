#pragma once
// A weld: both fields take their common velocity at every node they share, as a single field would.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Stick {
  struct Parameters {};

  template <int D, class S>
  MPM_HD static void apply(const Parameters&, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const S total = pair.mass_a + pair.mass_b;
    for (int i = 0; i < D; ++i)  // m_a (p_a + p_b) / (m_a + m_b) - p_a
      result.impulse[i] = (pair.mass_a * pair.momentum_b[i] - pair.mass_b * pair.momentum_a[i]) / total;
    result.dissipated = S(real<S>(0));
    result.status = S(real<S>(1));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_BYPASSES_DETECTION;
#endif
};

}  // namespace mpm
