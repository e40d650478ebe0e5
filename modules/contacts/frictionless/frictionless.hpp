#pragma once
// Bodies that press and slide freely: normal velocities match, nothing acts across the normal. Bardenhagen, Brackbill &
// Sulsky, Comput. Methods Appl. Mech. Engrg. 187 (2000) 529-541.

#include "kernel/sliding.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Frictionless {
  struct Parameters {};

  /// The pair acts when it approaches and the surfaces touch (separation <= 0).
  template <int D, class S>
  MPM_HD static void apply(const Parameters&, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const RelativeMotion<D, S> motion(pair);
    const scalar_of<S> zero = 0;
    strike(pair, motion, presses(pair, motion), S(zero), motion.slide_squared <= zero, result);
  }

#if MPM_HOST
  static constexpr unsigned traits = 0;
#endif
};

}  // namespace mpm
