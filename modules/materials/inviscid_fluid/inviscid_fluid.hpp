#pragma once
// Compressible fluid without viscosity, whose pressure is linear in its density: p = K (rho/rho0 - 1), tau = K (J - 1) I.
// The isothermal fluid of any textbook, e.g. Batchelor (1967), An Introduction to Fluid Dynamics, sec. 1.6.
//
// The state is e = J - 1: the stress is linear in it, so that neither a logarithm nor a power is taken, and it has all
// its digits where a liquid is, near J = 1.

#include "kernel/equation_of_state.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct InviscidFluid {
  struct Parameters {
    double bulk_modulus, density, tension;
  };
  template <class T>
  struct Constants {
    T modulus;   ///< K, Pa
    T speed;     ///< of sound, sqrt(K/density), the same at every density
    bool parts;  ///< there is no tension: where J > 1 there is no pressure
    MPM_HD explicit Constants(const Parameters& p)
        : modulus(T(p.bulk_modulus)), speed(T(sqrt(p.bulk_modulus / p.density))), parts(p.tension != 0) {}
  };
  template <int D, class S>
  struct State {
    S volume_change;  ///< e = J - 1
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// J of the step's end is J of its start times det(I + dt L). Nothing is dissipated.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>&, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const S e = state.volume_change, change = mpm::volume_change(L, dt);
    // A step that leaves no volume must not be rounded to one that leaves a little.
    state.volume_change = select(change > real<S>(-1), e + (real<S>(1) + e) * change, change);
    return S(real<S>(0));
  }

  /// tau = K (J - 1) I.
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau{};
    for (int i = 0; i < 3; ++i) tau.s[i] = c.modulus * felt(c, state);
    return tau;
  }

  /// K (J - 1 - ln J), J/m^3: minus the integral of p from 1 to J.
  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return c.modulus * exponential_excess(log_of_change(felt(c, state)));
  }

  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>&) {
    return S(c.speed);
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return real<S>(1) + state.volume_change;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(bulk_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "bulk modulus K at rest; density (10 v)^2 keeps the density of flows at speed v within 1 %"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "density at rest"),
      MPM_CHOICE_PARAMETER(tension, "kept|none", 0, "none: there is no pressure below zero"),
  };
  static constexpr mpm_state state[] = {
      {"volume_change", "", "J - 1, J = density at rest over density", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
  };
#endif

 private:
  /// The part of J - 1 that the pressure sees.
  template <int D, class S>
  MPM_HD static S felt(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return c.parts ? min(state.volume_change, S(real<S>(0))) : state.volume_change;
  }
};

}  // namespace mpm
