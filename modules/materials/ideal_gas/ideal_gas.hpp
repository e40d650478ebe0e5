#pragma once
// Ideal gas that keeps the heat of its shocks: p = (g - 1) density times internal energy. von Neumann & Richtmyer,
// J. Appl. Phys. 21 (1950) 232 (viscosity that spreads a shock over cells); Landshoff, LA-1930 (1955) (its linear part).
//
// The state is ln J and the heating a: p J^g = p0 (1 + a). A step at constant entropy leaves a as it is, whatever its
// size, and only the work of the artificial viscosity changes it.

#include "kernel/artificial_viscosity.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct IdealGas {
  struct Parameters {
    double pressure, density, heat_capacity_ratio, quadratic_viscosity, linear_viscosity;
    double cell_size;  ///< m, of the grid: a shock is spread over its cells
  };
  template <class T>
  struct Constants {
    T pressure;  ///< p0, Pa
    T excess;    ///< g - 1
    T ratio;     ///< g
    T sound;     ///< squared speed of sound at rest, m^2/s^2
    ArtificialViscosity<T> viscosity;
    T inverse_cell_size;
    MPM_HD explicit Constants(const Parameters& p)
        : pressure(T(p.pressure)),
          excess(T(p.heat_capacity_ratio - 1)),
          ratio(T(p.heat_capacity_ratio)),
          sound(T(p.heat_capacity_ratio * p.pressure / p.density)),
          viscosity{T(p.density), T(p.linear_viscosity * p.cell_size),
                    T(p.quadratic_viscosity * p.cell_size * p.cell_size)},
          inverse_cell_size(T(1 / p.cell_size)) {}
  };
  template <int D, class S>
  struct State {
    S log_volume_ratio;  ///< ln J
    S heating;           ///< a, so that p J^g = p0 (1 + a)
    S shock_pressure;    ///< J times the pressure of the artificial viscosity in the last step, Pa
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// The energy never leaves the gas, so no step dissipates. Half of a step's viscous work heats at the volume before it
  /// and half at the volume after: the trapezoidal rule of da = (g - 1) J^(g - 1) dQ / p0. A step that expands takes no
  /// heat back, so that the entropy never falls.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const S before = state.log_volume_ratio, change = log_of_change(volume_change(L, dt));
    const S after = before + change;
    const S speed = sqrt(squared_sound(c, before, state.heating));
    const S viscous = c.viscosity.pressure(compression_rate(change, dt), speed);
    const S work = real<S>(0.5) * max(-change, S(real<S>(0))) * (state.shock_pressure + viscous);
    const S weight = real<S>(0.5) * (exp(c.excess * before) + exp(c.excess * after));
    state.heating = state.heating + c.excess * weight * work / c.pressure;
    state.log_volume_ratio = after, state.shock_pressure = viscous;
    return S(real<S>(0));
  }

  /// tau = -J (p - p0 + q) I.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const S l = state.log_volume_ratio;
    const S pressure = c.pressure * exp(l) * (exponential_change(-(c.ratio * l)) + state.heating * exp(-(c.ratio * l)));
    Sym<D, S> tau{};
    for (int i = 0; i < 3; ++i) tau.s[i] = -(pressure + state.shock_pressure);
    return tau;
  }

  /// Internal energy above that at rest, less the work that the surroundings' p0 has done.
  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const S l = state.log_volume_ratio, less = -(c.excess * l);
    return c.pressure * ((exponential_excess(less) + state.heating * exp(less)) / c.excess + exponential_excess(l));
  }

  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const S squared = squared_sound(c, state.log_volume_ratio, state.heating);
    return c.viscosity.damped_speed(squared, state.shock_pressure, c.inverse_cell_size);
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return exp(state.log_volume_ratio);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(pressure, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "p0 at rest, which the surroundings have too; 101325 Pa is the atmosphere"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "density at rest"),
      MPM_NUMBER_PARAMETER(heat_capacity_ratio, "", 1.4, 1.01, 10.0, 0, "g; 1.4 is air, 5/3 one atom a molecule"),
      MPM_NUMBER_PARAMETER(quadratic_viscosity, "", 2.0, 0.0, 100.0, 0,
                           "artificial viscosity per (cell size times rate)^2; spreads strong shocks over cells"),
      MPM_NUMBER_PARAMETER(
          linear_viscosity, "", 0.5, 0.0, 100.0, 0,
          "artificial viscosity per cell size times rate times speed of sound; calms what rings behind"),
  };
  static constexpr mpm_state state[] = {
      {"log_volume_ratio", "", "ln J, J = density at rest over density", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
      {"heating", "", "p J^g / p0 - 1, by how much shocks have raised the entropy", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
      {"shock_pressure", "Pa", "J times the pressure of the artificial viscosity in the last step", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
  };
#endif

 private:
  template <class S>
  MPM_HD static S squared_sound(const Constants<scalar_of<S>>& c, const S& log_volume_ratio, const S& heating) {
    return c.sound * (real<S>(1) + heating) * exp(-(c.excess * log_volume_ratio));
  }
};

}  // namespace mpm
