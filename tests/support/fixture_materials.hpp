#pragma once
// Materials that use what the boundary offers and no shipped one needs yet.

#include "materials/neo_hookean/neo_hookean.hpp"
#include "materials/von_mises/von_mises.hpp"
#include "plugin/sdk.hpp"

namespace mpm::test {

/// A rubber that swells when it is warm: psi = psi_neo_hookean - 3 lambda alpha (T - T0) ln J.
struct WarmRubber {
  static constexpr double reference_temperature = 293.15;

  struct Parameters {
    double youngs_modulus, poisson_ratio, density, expansion;
  };
  template <class T>
  struct Constants {
    NeoHookean::Constants<T> solid;
    T swelling;  ///< 3 lambda alpha, Pa/K
    MPM_HD explicit Constants(const Parameters& p)
        : solid(NeoHookean::Parameters{p.youngs_modulus, p.poisson_ratio, p.density, 0, 0}),
          swelling(T(3 * p.expansion * lame_lambda(p.youngs_modulus, p.poisson_ratio))) {}
  };
  template <class G>
  struct WarmState {
    G deformation_gradient;
    typename G::Scalar temperature;  ///< K, from the host
  };
  template <int D, class S>
  using State = WarmState<Mat<D, S>>;
  template <class S>
  using AxisymmetricState = WarmState<Deformation<2, S>>;

  template <class G>
  MPM_HD static ElasticState<G> solid(const WarmState<G>& state) {
    return {state.deformation_gradient};
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S warmth(const WarmState<G>& state) {
    return state.temperature - real<S>(reference_temperature);
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S advance(const Constants<scalar_of<S>>&, const G& L, scalar_of<S> dt, WarmState<G>& state) {
    state.deformation_gradient = advanced(state.deformation_gradient, L, dt);
    return S(real<S>(0));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const WarmState<G>& state) {
    Sym<G::dimension, S> tau = NeoHookean::kirchhoff_stress(c.solid, solid(state));
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] - c.swelling * warmth(state);
    return tau;
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const WarmState<G>& state) {
    return NeoHookean::stored_energy(c.solid, solid(state)) - c.swelling * warmth(state) * log(volume_ratio(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const WarmState<G>& state) {
    return NeoHookean::wave_speed(c.solid, solid(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const WarmState<G>& state) {
    return determinant(state.deformation_gradient);
  }

  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "Young's modulus"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(expansion, "1/K", 1e-4, 0.0, 1e-2, 0, "linear thermal expansion"),
  };
  static constexpr mpm_state state[] = {NeoHookean::state[0]};
};

/// Metal whose strength grows with the displacement over a cell, not with the strain: H = stiffness h.
struct BandHardening : VonMises {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, yield_stress, stiffness;
    double cell_size;  ///< m, from the host
  };
  template <class T>
  struct Constants : VonMises::Constants<T> {
    MPM_HD explicit Constants(const Parameters& p)
        : VonMises::Constants<T>(VonMises::Parameters{p.youngs_modulus, p.poisson_ratio, p.density, p.yield_stress,
                                                      p.stiffness * p.cell_size, 2}) {}
  };

  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "Young's modulus"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(yield_stress, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "yield stress"),
      MPM_NUMBER_PARAMETER(stiffness, "Pa/m", 1e6, 0.0, unbounded, 0, "yield stress gained a metre"),
  };
};

inline constexpr sdk::Manual fixture_manual{"fixture", "1.0.0", "a fixture", "none", "for tests", "Fixture"};

}  // namespace mpm::test
