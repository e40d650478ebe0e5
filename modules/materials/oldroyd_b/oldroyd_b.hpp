#pragma once
// Oldroyd-B liquid: a polymer of Maxwell elements with the upper-convected rate, a Newtonian solvent, and a volumetric
// energy. Oldroyd, Proc. R. Soc. A 200 (1950) 523; Bird, Armstrong & Hassager (1987), Dynamics of Polymeric Liquids,
// vol. 1, sec. 7.2, vol. 2, sec. 13.4 (Hookean dumbbells).
//   tau = G (A - I) + K J u' I + 2 eta_s J dev d,   G = eta_p/lambda
//   dA/dt = L A + A L^T - (A - I)/lambda            A = I at rest
// Energy G/2 (tr A - 3 - ln det A) + K u(J); the polymer dissipates G/(2 lambda) tr(A + A^-1 - 2 I) (Wapperom & Hulsen,
// J. Rheol. 42 (1998) 999), and the solvent 2 eta_s J dev d : d. The update of A: kernel/viscosity.hpp.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/viscosity.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct OldroydB {
  struct Parameters {
    double bulk_modulus, density, polymer_viscosity, relaxation_time, solvent_viscosity, volumetric_energy;
    double cell_size;
  };
  template <class T>
  struct Constants {
    T bulk, polymer, inverse_time, solvent_viscosity, inverse_density, inverse_cell_size;  ///< `polymer` is G, Pa
    VolumetricEnergy volumetric;
    MPM_HD explicit Constants(const Parameters& p)
        : bulk(T(p.bulk_modulus)),
          polymer(T(p.polymer_viscosity / p.relaxation_time)),
          inverse_time(T(1 / p.relaxation_time)),
          solvent_viscosity(T(p.solvent_viscosity)),
          inverse_density(T(1 / p.density)),
          inverse_cell_size(T(1 / p.cell_size)),
          volumetric(static_cast<VolumetricEnergy>(static_cast<int>(p.volumetric_energy))) {}
  };
  template <int D, class S>
  struct State {
    Sym<D, S> conformation;    ///< A, positive definite
    Sym<D, S> solvent_stress;  ///< Kirchhoff, Pa, of the last step
    S volume_ratio;            ///< J
  };
  template <class S>
  using AxisymmetricState = State<2, S>;

  /// Returns the energy dissipated, J/m^3, by the polymer and the solvent; never negative.
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    const G f = advanced(G::identity(), L, dt);
    state.volume_ratio = state.volume_ratio * determinant(f);
    const Sym<D, S> e = strain_rate(L, dt), d = rate_of_deformation(e, dt), before = state.conformation;
    Sym<D, S> strain;
    for (int k = 0; k < Sym<D, S>::size; ++k) strain.s[k] = dt * e.s[k];
    const Relaxation<scalar_of<S>> relaxation(dt * c.inverse_time);
    state.conformation = relaxed(pushed(f, before), strain, relaxation);
    state.solvent_stress = newtonian_stress(c.solvent_viscosity, scalar_of<S>(0), d);
    for (int k = 0; k < Sym<D, S>::size; ++k)
      state.solvent_stress.s[k] = state.volume_ratio * state.solvent_stress.s[k];
    return real<S>(0.5) * c.polymer * network_heat(before, state.conformation, relaxation) +
           dt * contraction(state.solvent_stress, d);
  }

  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau;
    for (int k = 0; k < Sym<D, S>::size; ++k) {
      const S stretched = k < 3 ? state.conformation.s[k] - real<S>(1) : state.conformation.s[k];
      tau.s[k] = c.polymer * stretched + state.solvent_stress.s[k];
    }
    const S pressure = c.bulk * volumetric_stress(c.volumetric, state.volume_ratio);
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] + pressure;
    return tau;
  }

  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return real<S>(0.5) * c.polymer * network_energy(state.conformation) +
           c.bulk * volumetric_energy(c.volumetric, state.volume_ratio);
  }

  /// The fastest wave of the instant, when the polymer is a Neo-Hookean network: longitudinal K J^2 u'' + G (1 + n.A.n),
  /// or shear G n.A.n; raised so that a step by it stands the solvent's stress too.
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    const S J = state.volume_ratio, shear = c.polymer * largest_eigenvalue_bound(state.conformation);
    const S longitudinal = shear + c.polymer + c.bulk * volumetric_tangent(c.volumetric, J);
    const scalar_of<S> viscosity = real<S>(4.0 / 3.0) * c.solvent_viscosity;
    return damped_wave_speed(c.inverse_density * max(longitudinal, shear), c.inverse_density * viscosity * J,
                             c.inverse_cell_size);
  }

  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return state.volume_ratio;
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_VISCOUS_FLOW;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(bulk_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "bulk modulus K of the liquid"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(polymer_viscosity, "Pa s", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "eta_p, what the polymer adds to the viscosity of slow flows"),
      MPM_NUMBER_PARAMETER(relaxation_time, "s", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "lambda, in which the polymer's stress falls by e"),
      MPM_NUMBER_PARAMETER(solvent_viscosity, "Pa s", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "eta_s of the Newtonian solvent"),
      MPM_CHOICE_PARAMETER(volumetric_energy, "logarithmic|quadratic|simo", 2, "u(J), see neo_hookean"),
  };
  static constexpr mpm_state state[] = {
      {"conformation", "", "conformation tensor A of the polymer", MPM_STATE_SYMMETRIC, MPM_INITIAL_IDENTITY},
      {"solvent_stress", "Pa", "the solvent's part of the Kirchhoff stress, of the last step", MPM_STATE_SYMMETRIC,
       MPM_INITIAL_ZERO},
      {"volume_ratio", "", "total J = det F", MPM_STATE_SCALAR, MPM_INITIAL_ONE},
  };
#endif
};

}  // namespace mpm
