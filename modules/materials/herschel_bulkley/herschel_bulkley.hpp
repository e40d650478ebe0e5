#pragma once
// Herschel-Bulkley fluid: an elastic solid below its yield stress, above it a fluid whose shear stress is
// tau_y + k (rate)^n. Pressures are those of kernel/equation_of_state.hpp. Yue, Smith, Batty, Zheng & Grinspun (2015),
// Continuum foam: a material point method for shear-dependent flows, ACM Trans. Graph. 34(5):160, sec. 4.
//
//   psi = U(J) + G/2 (tr b_e - 3),   det b_e = 1,   tau = -p J I + G dev b_e
//   |dev tau|/sqrt 2 = tau_y + k g^n where it flows, at the rate g = sqrt(2 d:d) of the viscous flow d
//
// The return is radial, as of metals (kernel/unimodular.hpp), and implicit: with the trial stress t and the viscosity
// a = G dt tr(b_e)/3 of the elastic part it solves k g^n + a g = t - tau_y for g, in closed form where n = 1. So the
// flow is stable at any viscosity, and the elastic waves alone say how long a step may be.

#include "kernel/elasticity.hpp"
#include "kernel/equation_of_state.hpp"
#include "kernel/functor.hpp"
#include "kernel/unimodular.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct HerschelBulkley {
  struct Parameters {
    MPM_EQUATION_OF_STATE_MEMBERS;
    double density, shear_modulus, yield_stress, consistency, flow_index;
  };
  template <class T>
  struct Constants {
    Barotropic<T> fluid;
    T inverse_density, mu, yield_stress;
    T consistency, log_consistency, flow_index;
    bool linear;  ///< Bingham: n = 1
    MPM_HD explicit Constants(const Parameters& p)
        : fluid(p),
          inverse_density(T(1 / p.density)),
          mu(T(p.shear_modulus)),
          yield_stress(T(p.yield_stress)),
          consistency(T(p.consistency)),
          log_consistency(T(log(p.consistency))),
          flow_index(T(p.flow_index)),
          linear(p.flow_index == 1) {}
  };
  template <int D, class S>
  struct State {
    Sym<D, S> elastic_left_cauchy_green;  ///< isochoric, det = 1
    S log_volume_ratio;                   ///< ln of the total J
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// The rate of flow g >= 0 for which k g^n + a g is the overstress.
  ///
  /// For n other than 1 Newton's method finds x = ln g from ln(k e^(n x) + a e^x) - ln(overstress) = 0. This function is
  /// convex and grows, with slopes between n and 1, and where each of both terms alone would be the overstress it is
  /// between 0 and ln 2. From there Newton's method goes down to the root and not beyond. Six steps suffice for n >= 0.1.
  template <class S>
  MPM_HD static S flow_rate(const Constants<scalar_of<S>>& c, const S& overstress, const S& elastic) {
    if (c.linear) return overstress / (c.consistency + elastic);
    const S target = log(max(overstress, S(real<S>(1e-30))));
    const S from_flow = c.log_consistency - target, from_elastic = log(elastic) - target;
    S x = min(-from_elastic, -from_flow / c.flow_index);
    for (int iteration = 0; iteration < 6; ++iteration) {
      const S flow = exp(from_flow + c.flow_index * x), spring = exp(from_elastic + x), both = flow + spring;
      x = x - log(both) * both / (c.flow_index * flow + spring);
    }
    return exp(x);
  }

  /// Returns the energy dissipated by flow, J/m^3: the rate times its work-conjugate stress at the end of the step.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    using T = scalar_of<S>;
    const S zero = S(real<S>(0));
    state.log_volume_ratio = state.log_volume_ratio + log_of_change(volume_change(L, dt));
    const Sym<D, S> b = unimodular(pushed(advanced(G::identity(), L, dt), state.elastic_left_cauchy_green));

    const S mean = trace(b) * real<S>(1.0 / 3.0);
    Sym<D, S> d = deviator(b);
    const T root_half = real<S>(0.7071067811865476);
    const S stress = root_half * c.mu * sqrt(squared_norm(d)), overstress = stress - c.yield_stress;
    const auto yields = overstress > real<S>(0);
    if (!any(yields)) {
      state.elastic_left_cauchy_green = b;
      return zero;
    }
    const S elastic = c.mu * dt * mean;
    const S rate = select(yields, flow_rate(c, overstress, elastic), zero);
    const S shrink = real<S>(1) - elastic * rate / max(stress, S(real<S>(1e-30)));
    for (int k = 0; k < Sym<D, S>::size; ++k) d.s[k] = shrink * d.s[k];
    const S new_mean = select(yields, unimodular_mean(d, mean), mean);
    const S conjugate = mean * conjugate_factor(d, new_mean);
    for (int i = 0; i < 3; ++i) d.s[i] = d.s[i] + new_mean;
    // d + mean rounds: a particle that does not yield keeps b itself, whichever particles share its pack.
    for (int k = 0; k < Sym<D, S>::size; ++k) state.elastic_left_cauchy_green.s[k] = select(yields, d.s[k], b.s[k]);
    return select(yields, shrink * stress * (dt * rate) * conjugate, zero);
  }

  /// tau = G dev(b_e) - p J I.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau = deviator(state.elastic_left_cauchy_green);
    const S pressure = c.fluid.kirchhoff_pressure(state.log_volume_ratio);
    for (int k = 0; k < Sym<D, S>::size; ++k) tau.s[k] = c.mu * tau.s[k];
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] - pressure;
    return tau;
  }

  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return real<S>(0.5) * c.mu * (trace(state.elastic_left_cauchy_green) - real<S>(3)) +
           c.fluid.energy(state.log_volume_ratio);
  }

  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return sqrt(c.inverse_density *
                split_tangent(c.fluid.wave_modulus(state.log_volume_ratio), c.mu, state.elastic_left_cauchy_green));
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return exp(state.log_volume_ratio);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_VISCOUS_FLOW;
  MPM_EQUATION_OF_STATE_CLAMPS
  static constexpr mpm_parameter parameters[] = {
      MPM_EQUATION_OF_STATE_PARAMETERS,
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "density at rest"),
      MPM_NUMBER_PARAMETER(shear_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "elastic shear modulus G below the yield stress"),
      MPM_NUMBER_PARAMETER(yield_stress, "Pa", required, 0.0, unbounded, 0,
                           "yield stress tau_y in shear (Kirchhoff); 0 is a power-law fluid"),
      MPM_NUMBER_PARAMETER(
          consistency, "Pa", required, 0.0, unbounded, 0,
          "k: shear stress above tau_y at a rate of 1/s, in number k in Pa s^n; 0 is perfectly plastic"),
      MPM_NUMBER_PARAMETER(flow_index, "", 1.0, 0.1, 3.0, 0,
                           "n: 1 is Bingham, below 1 thins with the rate, above 1 thickens"),
  };
  static constexpr mpm_state state[] = {
      {"elastic_left_cauchy_green", "", "isochoric elastic left Cauchy-Green tensor, det = 1", MPM_STATE_SYMMETRIC,
       MPM_INITIAL_IDENTITY},
      {"log_volume_ratio", "", "ln J, J = density at rest over density", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm
