#pragma once
// A liquid at a wall: it presses as bodies do, and slips against a viscous traction eta v / b, with Navier's slip length b.
// Neto et al., Rep. Prog. Phys. 68 (2005) 2859-2897, eq. 1.

#include "kernel/sliding.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct LiquidContact {
  struct Parameters {
    double viscosity;    ///< eta, Pa s
    double slip_length;  ///< b, m
  };

  /// After the forces the sliding speed decays as exp(-eta A t / (b m)) while the surfaces touch, integrated exactly over
  /// the step; where less than `least_left` of it would be left the pair slides no more.
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    const scalar_of<S> zero = 0, one = 1;
    const RelativeMotion<D, S> motion(pair);
    const S touches = select(pair.separation <= zero, S(one), S(zero));
    const S presses = select(motion.approach > zero, touches, S(zero));
    const S rate = real<S>(p.viscosity / p.slip_length) * pair.area / motion.reduced_mass;
    const S drags = pair.after_forces ? touches : S(zero);
    const S share = drags * share_lost(rate * pair.dt);
    S largest(zero);
    for (int i = 0; i < D; ++i) {
      result.impulse[i] = motion.reduced_mass * (share * motion.slide[i] - presses * motion.approach * pair.normal[i]);
      largest = max(largest, max(result.impulse[i], -result.impulse[i]));
    }
    result.dissipated = motion.reduced_mass * share * motion.slide_squared * (one - real<S>(0.5) * share);
    const S rests = select((one - share) * motion.slide_squared > zero, S(zero), S(one));
    result.status = select(largest > zero, real<S>(2) - rests, S(zero));
  }

  static constexpr double least_left = 4e-6;

  /// 1 - exp(-x), where x is small by the series, whose terms do not cancel.
  template <class S>
  MPM_HD static S share_lost(S x) {
    const scalar_of<S> one = 1;
    const S left = exp(-x), small = min(x, S(real<S>(0.5)));
    S series(one);
    for (int k = 14; k > 1; --k) series = one - small / real<S>(k) * series;
    return select(x <= real<S>(0.5), small * series, select(left < real<S>(least_left), S(one), one - left));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_ACTS_OVER_TIME;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(viscosity, "Pa s", required, 0.0, unbounded, 0, "viscosity of the liquid"),
      MPM_NUMBER_PARAMETER(slip_length, "m", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "how far beyond the wall the liquid's speed would fall to that of the wall"),
  };
#endif
};

}  // namespace mpm
