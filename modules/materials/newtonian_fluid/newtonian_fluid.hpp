#pragma once
// Weakly compressible Newtonian fluid: tau = -p J I + 2 mu J dev(D) + zeta J tr(D) I, with an equation of state p(J)
// (kernel/equation_of_state.hpp). Weakly compressible water of this kind: Monaghan, J. Comput. Phys. 110 (1994) 399.
//
// D is that of a whole step, (f f^T - I)/(2 dt) = sym L + dt L L^T/2 with f = I + dt L. A frame that turns between the
// steps turns it exactly, which sym L alone is not.

#include "kernel/equation_of_state.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct NewtonianFluid {
  struct Parameters {
    MPM_EQUATION_OF_STATE_MEMBERS;
    double density, viscosity, bulk_viscosity;
    double cell_size;  ///< m, of the grid: how long a step viscosity allows depends on it
  };
  template <class T>
  struct Constants {
    Barotropic<T> fluid;
    T inverse_density;
    T two_mu, bulk_viscosity;
    T viscous_speed;  ///< (4 mu/3 + zeta)/(density h), m/s
    MPM_HD explicit Constants(const Parameters& p)
        : fluid(p),
          inverse_density(T(1 / p.density)),
          two_mu(T(2 * p.viscosity)),
          bulk_viscosity(T(p.bulk_viscosity)),
          viscous_speed(T((4 * p.viscosity / 3 + p.bulk_viscosity) / (p.density * p.cell_size))) {}
  };
  template <int D, class S>
  struct State {
    S log_volume_ratio;        ///< ln J
    Sym<D, S> viscous_stress;  ///< viscous part of tau in the last step
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// D of a whole step.
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> rate_of_deformation(const G& L, scalar_of<S> dt) {
    constexpr int D = G::dimension;
    const Mat<D, S>& l = in_plane(L);
    const scalar_of<S> half = real<S>(0.5);
    Sym<D, S> rate{};
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) {
        S square = l(i, 0) * l(j, 0);
        for (int k = 1; k < D; ++k) square = square + l(i, k) * l(j, k);
        rate(i, j) = half * (l(i, j) + l(j, i) + dt * square);
      }
    if constexpr (has_zz<G>) rate.s[2] = L.zz + half * dt * L.zz * L.zz;
    return rate;
  }

  /// Returns the energy dissipated by viscous flow, J/m^3.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    state.log_volume_ratio = state.log_volume_ratio + log_of_change(volume_change(L, dt));
    const Sym<D, S> rate = rate_of_deformation(L, dt);
    const S expansion = trace(rate), J = volume_ratio(state);
    Sym<D, S> stress = deviator(rate);
    const S power = c.two_mu * squared_norm(stress) + c.bulk_viscosity * expansion * expansion;
    for (int k = 0; k < Sym<D, S>::size; ++k) stress.s[k] = c.two_mu * J * stress.s[k];
    for (int i = 0; i < 3; ++i) stress.s[i] = stress.s[i] + c.bulk_viscosity * J * expansion;
    state.viscous_stress = stress;
    return dt * J * power;
  }

  /// tau = -p J I + the viscous stress.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau = state.viscous_stress;
    const S pressure = c.fluid.kirchhoff_pressure(state.log_volume_ratio);
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] - pressure;
    return tau;
  }

  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return c.fluid.energy(state.log_volume_ratio);
  }

  /// The speed s whose step h/s is the longest of a wave that changes sign from cell to cell: with x = dt/h it has
  /// c^2 x^2 + 2 (nu/h) x = 1 where waves run at c and viscosity damps them with nu = (4 mu/3 + zeta) J/density.
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const S square = c.inverse_density * c.fluid.wave_modulus(state.log_volume_ratio);
    const S viscous = c.viscous_speed * volume_ratio(state);
    return viscous + sqrt(viscous * viscous + square);
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return exp(state.log_volume_ratio);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_parameter parameters[] = {
      MPM_EQUATION_OF_STATE_PARAMETERS,
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "density at rest"),
      MPM_NUMBER_PARAMETER(viscosity, "Pa s", required, 0.0, unbounded, 0, "shear viscosity mu; 0.001 Pa s is water"),
      MPM_NUMBER_PARAMETER(bulk_viscosity, "Pa s", 0.0, 0.0, unbounded, 0, "bulk viscosity zeta"),
  };
  static constexpr mpm_state state[] = {
      {"log_volume_ratio", "", "ln J, J = density at rest over density", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
      {"viscous_stress", "Pa", "viscous part of the Kirchhoff stress in the last step", MPM_STATE_SYMMETRIC,
       MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm
