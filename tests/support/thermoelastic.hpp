#pragma once
// Linear elasticity with thermal expansion, small strains: sigma = C : (eps - alpha (T - T0) I) (Timoshenko & Goodier
// 1970, ch. 13). What no shipped material does yet: it asks for the temperature, and notes the one that it was strained
// at. Device-safe, as the functors of plugins are.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm::test {

struct Thermoelastic {
  static constexpr double reference_temperature = 300;

  struct Parameters {
    double youngs_modulus, poisson_ratio, density, expansion, heating;
  };
  template <class T>
  struct Constants {
    T mu, lambda, expansion, heating, longitudinal_speed;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          expansion(T(p.expansion)),
          heating(T(p.heating)),
          longitudinal_speed(sqrt((lambda + 2 * mu) / T(p.density))) {}
  };
  template <int D, class S>
  struct State {
    Mat<D, S> deformation_gradient;
    S strained_at;  ///< K
    S temperature;  ///< K, from the host
  };

  /// What heats it stands for a dissipation that does not depend on the strain.
  template <int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const Mat<D, S>& L, scalar_of<S> dt, State<D, S>& state) {
    state.deformation_gradient = advanced(state.deformation_gradient, L, dt);
    state.strained_at = state.temperature;
    return S(c.heating * dt);
  }
  /// The elastic part, eps - alpha (T - T0) I.
  template <int D, class S>
  MPM_HD static Sym<D, S> strain(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const Mat<D, S>& F = state.deformation_gradient;
    Sym<D, S> e{};
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) e(i, j) = real<S>(0.5) * (F(i, j) + F(j, i));
    for (int i = 0; i < D; ++i) e(i, i) = e(i, i) - real<S>(1);
    for (int i = 0; i < 3; ++i) e.s[i] = e.s[i] - c.expansion * (state.temperature - real<S>(reference_temperature));
    return e;
  }
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> e = strain(c, state);
    const S mean = c.lambda * trace(e);
    for (int k = 0; k < Sym<D, S>::size; ++k) e.s[k] = real<S>(2) * c.mu * e.s[k];
    for (int i = 0; i < 3; ++i) e.s[i] = e.s[i] + mean;
    return e;
  }
  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const Sym<D, S> e = strain(c, state);
    return c.mu * squared_norm(e) + real<S>(0.5) * c.lambda * trace(e) * trace(e);
  }
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>&) {
    return S(c.longitudinal_speed);
  }
  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return determinant(state.deformation_gradient);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_DISSIPATES;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "Young's modulus"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(expansion, "1/K", required, 0.0, unbounded, 0, "linear thermal expansion"),
      MPM_NUMBER_PARAMETER(heating, "W/m^3", 0.0, 0.0, unbounded, 0, "power dissipated, whatever the strain"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"strained_at", "K", "temperature at the last strain", MPM_STATE_SCALAR, MPM_INITIAL_ZERO},
  };
#endif
};

}  // namespace mpm::test
