#pragma once
// Weakly compressible Newtonian fluid: tau = -p J I + 2 mu J dev(D) + zeta J tr(D) I, with an equation of state p(J)
// (kernel/equation_of_state.hpp). Weakly compressible water of this kind: Monaghan, J. Comput. Phys. 110 (1994) 399.
//
// D is that of a whole step, (f f^T - I)/(2 dt) = sym L + dt L L^T/2 with f = I + dt L. A frame that turns between the
// steps turns it exactly, which sym L alone is not.

#include "kernel/equation_of_state.hpp"
#include "kernel/functor.hpp"
#include "kernel/viscosity.hpp"
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
    T viscosity, bulk_viscosity, inverse_cell_size;
    T longitudinal;  ///< (4 mu/3 + zeta)/density, m^2/s
    MPM_HD explicit Constants(const Parameters& p)
        : fluid(p),
          inverse_density(T(1 / p.density)),
          viscosity(T(p.viscosity)),
          bulk_viscosity(T(p.bulk_viscosity)),
          inverse_cell_size(T(1 / p.cell_size)),
          longitudinal(T((4 * p.viscosity / 3 + p.bulk_viscosity) / p.density)) {}
  };
  template <int D, class S>
  struct State {
    S log_volume_ratio;        ///< ln J
    Sym<D, S> viscous_stress;  ///< viscous part of tau in the last step
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// Returns the energy dissipated by viscous flow, J/m^3.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    state.log_volume_ratio = state.log_volume_ratio + log_of_change(volume_change(L, dt));
    const S J = volume_ratio(state);
    Sym<D, S> rate = strain_rate(L, dt);
    for (int k = 0; k < Sym<D, S>::size; ++k) rate.s[k] = real<S>(0.5) * rate.s[k];
    state.viscous_stress = kirchhoff_of(newtonian_stress(c.viscosity, c.bulk_viscosity, rate), J);
    return dt * max(contraction(state.viscous_stress, rate), S(real<S>(0)));
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

  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const S squared = c.inverse_density * c.fluid.wave_modulus(state.log_volume_ratio);
    return damped_wave_speed(squared, c.longitudinal * volume_ratio(state), c.inverse_cell_size);
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
