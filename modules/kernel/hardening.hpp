#pragma once
// How the yield stress of a metal grows, shared by the plastic materials: linear, power law (Swift), Voce, a table, Johnson-Cook; and
// the plastic strain of a step under a law that has no closed form.
//
// A law is a small struct of constants in the precision T. It gives `yield_stress(strain)`, the stress in Pa from which the
// material flows at an equivalent plastic strain, and `flow(strain, increment)`, the stress during a step that ends at
// `strain` and flowed by `increment`, with its derivative by the increment. No law softens as it flows.

#include "kernel/math.hpp"

namespace mpm {

/// Flow stress and its derivative by the plastic strain of the step, both in Pa.
template <class S>
struct FlowStress {
  S stress, slope;
};

/// A bound below all plastic strains that count; what a power gives at less is what it gives here.
template <class S>
MPM_HD constexpr scalar_of<S> least_strain() {
  return sizeof(scalar_of<S>) == 4 ? real<S>(1e-37) : real<S>(1e-300);
}

/// The power x^exponent of x >= 0 for an exponent above 0, by its logarithm.
template <class S>
MPM_HD S power_of(S x, scalar_of<S> exponent) {
  const S zero = S(real<S>(0));
  return select(x > real<S>(0), exp(exponent * log(max(x, S(least_strain<S>())))), zero);
}

/// sigma = sigma_0 + H alpha.
template <class T>
struct LinearHardening {
  T initial, modulus;

  template <class S>
  MPM_HD S yield_stress(S strain) const {
    return initial + modulus * strain;
  }
  template <class S>
  MPM_HD FlowStress<S> flow(S strain, S) const {
    return {yield_stress(strain), S(modulus)};
  }
};

/// sigma = sigma_0 (1 + alpha/eps_0)^n, Swift, J. Mech. Phys. Solids 1 (1952) 1, whose k (eps_0 + alpha)^n starts at sigma_0.
template <class T>
struct PowerLawHardening {
  T initial, inverse_reference_strain, exponent;

  template <class S>
  MPM_HD S yield_stress(S strain) const {
    return initial * exp(exponent * log(real<S>(1) + inverse_reference_strain * strain));
  }
  template <class S>
  MPM_HD FlowStress<S> flow(S strain, S) const {
    const S stress = yield_stress(strain);
    return {stress, exponent * inverse_reference_strain * stress / (real<S>(1) + inverse_reference_strain * strain)};
  }
};

/// sigma = sigma_0 + Q (1 - exp(-alpha/eps_s)) + H alpha. Voce, J. Inst. Metals 74 (1948) 537; its usual form
/// with a linear part.
template <class T>
struct VoceHardening {
  T initial, saturation, inverse_saturation_strain, modulus;

  template <class S>
  MPM_HD FlowStress<S> flow(S strain, S) const {
    const S missing = saturation * exp(-(inverse_saturation_strain * strain));
    return {initial + (saturation - missing) + modulus * strain, inverse_saturation_strain * missing + modulus};
  }
  template <class S>
  MPM_HD S yield_stress(S strain) const {
    return flow(strain, strain).stress;
  }
};

/// sigma along straight lines between points (alpha, sigma), from (0, sigma_0) on; beyond the last it stays. The points' strains
/// grow, and their stresses do not fall.
template <class T, int Points>
struct TableHardening {
  T initial;
  T start[Points], width[Points],
      modulus[Points];  ///< of each line: the strain it begins at, its length in strain, its slope

  template <class S>
  MPM_HD FlowStress<S> flow(S strain, S) const {
    const S zero = S(real<S>(0));
    FlowStress<S> r{S(initial), zero};
    for (int k = 0; k < Points; ++k) {
      const S along = strain - start[k];
      r.stress = r.stress + modulus[k] * min(max(along, zero), S(width[k]));
      r.slope = select(along < zero, r.slope, select(along < width[k], S(modulus[k]), zero));
    }
    return r;
  }
  template <class S>
  MPM_HD S yield_stress(S strain) const {
    return flow(strain, strain).stress;
  }
};

/// The straight lines through points whose x grow, as many as there are `lines`; beyond the last the value stays.
template <class T, int Points>
MPM_HD TableHardening<T, Points> lines_through(const double* x, const double* y, int lines) {
  TableHardening<T, Points> law{T(y[0]), {}, {}, {}};
  for (int k = 0; k < Points; ++k) {
    const bool used = k < lines;
    law.start[k] = T(x[used ? k : lines]);
    if (!used) continue;
    law.width[k] = T(x[k + 1] - x[k]);
    law.modulus[k] = T((y[k + 1] - y[k]) / (x[k + 1] - x[k]));
  }
  return law;
}

/// sigma = (A + B alpha^n) (1 + C ln(rate/rate_0)) (1 - T*^m),  T* = (T - T_room)/(T_melt - T_room) within 0 and 1, and
/// rates below rate_0 count as rate_0. Johnson & Cook, Proc. 7th Int. Symp. on Ballistics (1983) 541.
template <class T>
struct JohnsonCookHardening {
  T initial, coefficient, exponent, rate_coefficient, reference_rate;
  T room_temperature, inverse_melting_range, thermal_exponent;
};

/// The Johnson-Cook law during one step of one particle: its temperature and the length of the step are known.
template <class T, class S>
struct JohnsonCookStep {
  S softening;       ///< 1 - T*^m
  T rate_over_flow;  ///< rate/rate_0 of a unit plastic strain in this step
  JohnsonCookHardening<T> law;

  MPM_HD JohnsonCookStep(const JohnsonCookHardening<T>& constants, S temperature, T dt)
      : rate_over_flow(real<S>(1) / (constants.reference_rate * dt)), law(constants) {
    const S one = S(real<S>(1)), zero = S(real<S>(0));
    const S warmth = (temperature - law.room_temperature) * law.inverse_melting_range;
    softening = one - power_of(min(max(warmth, zero), one), law.thermal_exponent);
  }

  MPM_HD S yield_stress(S strain) const {
    return softening * (law.initial + law.coefficient * power_of(strain, law.exponent));
  }
  MPM_HD FlowStress<S> flow(S strain, S increment) const {
    const S zero = S(real<S>(0)), one = S(real<S>(1)), tiny = S(least_strain<S>());
    const S base = max(strain, tiny), grown = law.coefficient * exp(law.exponent * log(base));
    const S at_rest = softening * (law.initial + select(strain > real<S>(0), grown, zero));
    const S at_rest_slope = softening * law.exponent * grown / base;
    const S rate = increment * rate_over_flow;
    const S factor = one + law.rate_coefficient * log(max(rate, one));
    const S factor_slope = select(rate > real<S>(1), law.rate_coefficient / max(increment, tiny), zero);
    return {at_rest * factor, at_rest_slope * factor + at_rest * factor_slope};
  }
};

/// A law as it acts on a particle during a step: most know neither its temperature nor the length of the step.
template <class Law, class State, class T>
MPM_HD const Law& during_step(const Law& law, const State&, T) {
  return law;
}
template <class State, class T>
MPM_HD auto during_step(const JohnsonCookHardening<T>& law, const State& state, T dt) {
  return JohnsonCookStep<T, decltype(state.temperature)>(law, state.temperature, dt);
}

/// The plastic strain x >= 0 of a step, with which the stress that is left, `trial` - `stiffness` x, is the flow stress of
/// the law: bracketed Newton. Zero where `yields` does not hold. Plain Newton fails where a law turns: Johnson-Cook's rate
/// factor starts at rate_0, and from either side of it the tangent may lead to the other for ever.
///
/// The bracket's upper end starts at the strain of a rate of 1/s and grows by 10 until the sign changes. No law softens, so
/// that the sign has changed at the latest where the flow stress of `before` alone takes up the overstress; this ends the
/// search. A step of Newton that leaves the bracket is replaced by its middle, at most 1000 times below its upper end.
/// Particles whose residual has vanished, or whose bracket is closed, stay as they are, so that no result depends on which
/// particles share a pack.
template <class Law, class S, class Mask>
MPM_HD S plastic_increment(const Law& law, S before, S trial, S stiffness, scalar_of<S> dt, const Mask& yields) {
  constexpr int most_decades = 12, most_iterations = 64;
  const S zero = S(real<S>(0)), one = S(real<S>(1));
  const scalar_of<S> rounding = sizeof(scalar_of<S>) == 4 ? real<S>(16 * 1.2e-7) : real<S>(16 * 2.3e-16);
  const S most = select(yields, max(trial - law.yield_stress(before), zero) / stiffness, zero);

  S low = zero, high = min(S(dt), most), x = high;
  FlowStress<S> flow = law.flow(before + x, x);
  for (int decade = 0; decade < most_decades; ++decade) {
    const S below = select(flow.stress + stiffness * x < trial, one, zero);
    const S wider = select(x < most, below, zero);
    if (!any(wider > real<S>(0))) break;
    low = select(wider > real<S>(0), x, low);
    high = select(wider > real<S>(0), decade + 1 < most_decades ? min(real<S>(10) * x, most) : most, high);
    x = high;
    flow = law.flow(before + x, x);
  }
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const S residual = flow.stress + stiffness * x - trial;
    const S open = select(high - low > rounding * high + least_strain<S>(), one, zero);
    const S unsolved = select(yields, select(abs(residual) > rounding * trial, open, zero), zero);
    if (!any(unsolved > real<S>(0))) break;
    low = select(residual < real<S>(0), x, low);
    high = select(residual < real<S>(0), high, x);
    const S newton = x - residual / (flow.slope + stiffness);
    const S middle = min(real<S>(0.5) * (low + high), max(real<S>(8) * low, real<S>(1e-3) * high));
    const S inside = select(newton > low, select(newton < high, newton, middle), middle);
    x = select(unsolved > real<S>(0), inside, x);
    flow = law.flow(before + x, x);
  }
  // One more step of Newton changes x by rounding; it makes the derivative of dual numbers that of the root. Where it would
  // change x by more, the overstress itself is rounding and the tangent says nothing.
  const S step = (flow.stress + stiffness * x - trial) / (flow.slope + stiffness);
  return select(yields, select(abs(step) < real<S>(1e-4) * x, min(x - step, most), x), zero);
}

/// The plastic multiplier of a radial return, sqrt(3/2) of the plastic strain, from the overstress |s| - sqrt(2/3) sigma.
/// Linear hardening has a closed form.
template <class T, class S, class Mask>
MPM_HD S plastic_multiplier(const LinearHardening<T>& law, S overstress, S, S two_mu_bar, S, T, const Mask& yields) {
  return select(yields, overstress / (two_mu_bar + real<S>(2.0 / 3.0) * law.modulus), S(real<S>(0)));
}
template <class Law, class S, class Mask>
MPM_HD S plastic_multiplier(const Law& law, S, S stress_norm, S two_mu_bar, S before, scalar_of<S> dt,
                            const Mask& yields) {
  const scalar_of<S> root_three_halves = real<S>(1.224744871391589);
  return root_three_halves *
         plastic_increment(law, before, root_three_halves * stress_norm, real<S>(1.5) * two_mu_bar, dt, yields);
}

}  // namespace mpm
