#pragma once
// Solid or liquid under shocks, without strength, whose heat presses: Mie-Gruneisen's equation of state about the Hugoniot,
// p = p_H (1 - G x/2) + G E with x = 1 - J, E the internal energy per initial volume, and density times Gruneisen's G
// constant. Meyers (1994), Dynamic Behavior of Materials, ch. 4 and 5; Menikoff & Plohr, Rev. Mod. Phys. 61 (1989) 75. Where
// J > 1 G is constant and the cold pressure linear in the density: a stiffened gas. The artificial viscosity: von Neumann &
// Richtmyer, J. Appl. Phys. 21 (1950) 232; Landshoff, LA-1930 (1955).
//
// At constant entropy dE = -p dJ is linear in E, so that a step takes E to a E + b. Where J > 1 both are closed forms. Where
// J < 1, E1 = e^(G (x1 - x0)) E0 + integral of e^(G (x1 - x)) p_H (1 - G x/2), by three points of Gauss, which are the same
// ones on the way there and back: closed ways give E back.

#include "kernel/artificial_viscosity.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct MieGruneisen {
  struct Parameters {
    double bulk_modulus, density, hugoniot_slope, gruneisen_parameter, tension, quadratic_viscosity, linear_viscosity;
    double cell_size;  ///< m, of the grid: a shock is spread over its cells
  };
  template <class T>
  struct Constants {
    T modulus;  ///< K, Pa
    ShockHugoniot<T> hugoniot;
    T gruneisen;  ///< G
    bool parts;   ///< the pressure without heat is not below zero: where J > 1 there is none
    T inverse_density;
    ArtificialViscosity<T> viscosity;
    T inverse_cell_size;
    MPM_HD explicit Constants(const Parameters& p)
        : modulus(T(p.bulk_modulus)),
          hugoniot{T(p.hugoniot_slope)},
          gruneisen(T(p.gruneisen_parameter)),
          parts(p.tension != 0),
          inverse_density(T(1 / p.density)),
          viscosity{T(p.density), T(p.linear_viscosity * p.cell_size),
                    T(p.quadratic_viscosity * p.cell_size * p.cell_size)},
          inverse_cell_size(T(1 / p.cell_size)) {}
  };
  template <int D, class S>
  struct State {
    S log_volume_ratio;  ///< ln J
    S internal_energy;   ///< E, J per m^3 of initial volume, above that at rest
    S shock_pressure;    ///< J times the pressure of the artificial viscosity in the last step, Pa
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// The energy never leaves the material, so no step dissipates. Half of a step's viscous work heats before its compression
  /// and half after it.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const S before = state.log_volume_ratio, change = log_of_change(mpm::volume_change(L, dt)), after = before + change;
    const S squared_speed = c.inverse_density * wave_modulus(c, state);
    const S viscous = c.viscosity.pressure(compression_rate(change, dt), sqrt(squared_speed));
    const S work = real<S>(0.5) * max(-change, S(real<S>(0))) * (state.shock_pressure + viscous);
    const Change<S> dense = compressed(c, before, after), thin = expanded(c, before, after);
    const S heated = state.internal_energy + real<S>(0.5) * work;
    state.internal_energy =
        select(change < real<S>(0), dense.of(thin.of(heated)), thin.of(dense.of(heated))) + real<S>(0.5) * work;
    state.log_volume_ratio = after, state.shock_pressure = viscous;
    return S(real<S>(0));
  }

  /// tau = -J (p + q) I.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const S l = state.log_volume_ratio, x = -exponential_change(l), E = state.internal_energy;
    const S thin = (c.parts ? S(real<S>(0)) : c.modulus * x) + c.gruneisen * E;
    const S pressure = select(l < real<S>(0), pressure_compressed(c, S(exp(l)), x, E), thin) + state.shock_pressure;
    Sym<D, S> tau{};
    for (int i = 0; i < 3; ++i) tau.s[i] = -pressure;
    return tau;
  }

  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>&, const State<D, S>& state) {
    return state.internal_energy;
  }

  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return c.viscosity.damped_speed(c.inverse_density * wave_modulus(c, state), state.shock_pressure,
                                    c.inverse_cell_size);
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return exp(state.log_volume_ratio);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE;
  MPM_HUGONIOT_CLAMPS(true)

  /// Refuses a parameter of Gruneisen by which the pressure without heat would fall before the clamp.
  static mpm_refusal refusal(const Parameters& p, const mpm_refusal_case&) {
    const double largest = p.hugoniot_slope * (1 + mie_gruneisen_reach) / mie_gruneisen_reach;
    if (p.gruneisen_parameter < largest) return {nullptr, nullptr, 0};
    return {"gruneisen_parameter",
            "the pressure of the cold material would fall as it is compressed, before s (1 - J) = 0.9", largest};
  }

  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(bulk_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "bulk modulus K at rest, density times the square of the shocks' slowest speed c"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "density at rest"),
      MPM_NUMBER_PARAMETER(hugoniot_slope, "", 1.489, 0.01, 4.0, 0,
                           "s, by which shocks are faster than sound: c + s u_p; 1.489 is copper"),
      MPM_NUMBER_PARAMETER(gruneisen_parameter, "", 1.99, 0.01, unbounded, 0,
                           "G, pressure by heat over heat per volume at rest; 1.99 is copper"),
      MPM_CHOICE_PARAMETER(tension, "kept|none", 0, "none: where J > 1 nothing but heat presses"),
      MPM_NUMBER_PARAMETER(quadratic_viscosity, "", 2.0, 0.0, 100.0, 0,
                           "artificial viscosity per (cell size times rate)^2; spreads strong shocks over cells"),
      MPM_NUMBER_PARAMETER(
          linear_viscosity, "", 0.5, 0.0, 100.0, 0,
          "artificial viscosity per cell size times rate times speed of sound; calms what rings behind"),
  };
  static constexpr mpm_state state[] = {
      {"log_volume_ratio", "", "ln J, J = density at rest over density", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
      {"internal_energy", "J/m^3", "internal energy per initial volume, above that at rest", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
      {"shock_pressure", "Pa", "J times the pressure of the artificial viscosity in the last step", MPM_STATE_SCALAR,
       MPM_INITIAL_ZERO},
  };
#endif

 private:
  /// What a step at constant entropy makes of an internal energy.
  template <class S>
  struct Change {
    S factor, added;
    MPM_HD S of(const S& energy) const { return factor * energy + added; }
  };
  /// The part of a step in which J < 1. `before` and `after` are ln J.
  template <class S>
  MPM_HD static Change<S> compressed(const Constants<scalar_of<S>>& c, const S& before, const S& after) {
    constexpr double outer = 0.38729833462074168852;  // half of sqrt(3/5): the middle to the other two points of Gauss
    const S zero = S(real<S>(0)), start = min(before, zero), end = min(after, zero);
    const S step = -(exp(start) * exponential_change(end - start)),
            middle = real<S>(0.5) * step - exponential_change(start);
    const S along = c.gruneisen * step, offset = real<S>(outer) * step, half = exp(real<S>(0.5) * along);
    const S first = exp(real<S>(0.5 + outer) * along) * cold_pressure(c, middle - offset);
    const S last = exp(real<S>(0.5 - outer) * along) * cold_pressure(c, middle + offset);
    return {half * half,
            step * (real<S>(5.0 / 18) * (first + last) + real<S>(8.0 / 18) * half * cold_pressure(c, middle))};
  }
  /// The part of a step in which J > 1.
  template <class S>
  MPM_HD static Change<S> expanded(const Constants<scalar_of<S>>& c, const S& before, const S& after) {
    const S zero = S(real<S>(0)), start = max(before, zero), end = max(after, zero);
    const S kept = exp(c.gruneisen * (start - end));
    return {kept, cold_energy(c, end) - kept * cold_energy(c, start)};
  }
  /// The energy at ln J = l >= 0 of what came there from rest at constant entropy, J/m^3.
  template <class S>
  MPM_HD static S cold_energy(const Constants<scalar_of<S>>& c, const S& l) {
    const S whole = exponential_excess(l) + exponential_excess(-(c.gruneisen * l)) / c.gruneisen;
    return c.parts ? S(real<S>(0)) : c.modulus / (scalar_of<S>(1) + c.gruneisen) * whole;
  }
  /// The pressure at a compression 0 <= x < 1 of a material without internal energy, Pa.
  template <class S>
  MPM_HD static S cold_pressure(const Constants<scalar_of<S>>& c, const S& x) {
    const auto compression = c.hugoniot.compression(x);
    return c.modulus * (cold_share(c, compression.within) * c.hugoniot.pressure(compression.within) +
                        cold_tangent(c, S(c.hugoniot.last())) * compression.beyond);
  }
  /// 1 - G x/2, the share of the pressure behind a shock that is not of heat.
  template <class S>
  MPM_HD static S cold_share(const Constants<scalar_of<S>>& c, const S& x) {
    return real<S>(1) - real<S>(0.5) * c.gruneisen * x;
  }
  /// The derivative of the cold pressure by x, over K, where the formula stands.
  template <class S>
  MPM_HD static S cold_tangent(const Constants<scalar_of<S>>& c, const S& within) {
    return cold_share(c, within) * c.hugoniot.tangent(within) -
           real<S>(0.5) * c.gruneisen * c.hugoniot.pressure(within);
  }
  /// J p, Pa, where J < 1.
  template <class S>
  MPM_HD static S pressure_compressed(const Constants<scalar_of<S>>& c, const S& J, const S& x, const S& energy) {
    return J * (cold_pressure(c, x) + c.gruneisen * energy);
  }
  /// Density at rest times the squared speed of sound, -J^2 dp/dJ at constant entropy. A material that has parted is taken
  /// for as stiff as at rest, which it is once it is together again; one that is torn holds on by nothing.
  template <int D, class S>
  MPM_HD static S wave_modulus(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const S l = state.log_volume_ratio, J = exp(l), x = -exponential_change(l), E = state.internal_energy;
    const S dense = J * (J * c.modulus * cold_tangent(c, c.hugoniot.compression(x).within) +
                         c.gruneisen * pressure_compressed(c, J, x, E));
    const S cold = c.parts ? S(c.modulus) : c.modulus * exp(-(c.gruneisen * l));
    const S thin = cold + c.gruneisen * (scalar_of<S>(1) + c.gruneisen) * (E - cold_energy(c, l));
    return max(select(l < real<S>(0), dense, thin), S(c.modulus * scalar_of<S>(1e-12)));
  }
};

}  // namespace mpm
