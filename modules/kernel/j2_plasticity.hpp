#pragma once
// Finite-strain J2 plasticity without a spectral decomposition: split Neo-Hookean elasticity, radial return on the
// deviatoric Kirchhoff stress, isotropic hardening. Simo & Hughes (1998), Computational Inelasticity, box 9.1, with one
// change: after the return tr(b_e) is chosen so that det(b_e) = 1 (box 9.1 keeps the trial trace, which would store energy
// that was dissipated). The functors of `von_mises` and its kin derive from J2Plasticity and bring their law of hardening.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/hardening.hpp"
#include "kernel/unimodular.hpp"

namespace mpm {

/// What a particle of metal keeps.
template <int D, class S>
struct J2State {
  Sym<D, S> elastic_left_cauchy_green;  ///< isochoric, det = 1
  S volume_ratio;                       ///< total J
  S equivalent_plastic_strain;
};

/// The same beside its temperature, for laws that read it.
template <int D, class S>
struct WarmJ2State {
  Sym<D, S> elastic_left_cauchy_green;
  S volume_ratio;
  S equivalent_plastic_strain;
  S temperature;  ///< K, from the host
};

/// Constants of a metal in the precision T; `Law` is one of kernel/hardening.hpp.
template <class T, class Law>
struct J2Constants {
  T mu, bulk, inverse_density;
  VolumetricEnergy volumetric;
  Law hardening;

  /// `p` has youngs_modulus, poisson_ratio, density and volumetric_energy.
  template <class Parameters>
  MPM_HD J2Constants(const Parameters& p, const Law& law)
      : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
        bulk(T(bulk_modulus(p.youngs_modulus, p.poisson_ratio))),
        inverse_density(T(1 / p.density)),
        volumetric(static_cast<VolumetricEnergy>(static_cast<int>(p.volumetric_energy))),
        hardening(law) {}
};

struct J2Plasticity {
  /// Returns the energy dissipated by plastic flow, J/m^3: the plastic multiplier times its work-conjugate stress at
  /// the end of the step, which is |s| for small elastic strains. (The stored energy that the return removes from the
  /// trial state is E de^2/2 a step more, which no force has supplied.)
  template <class Constants, class G, template <int, class> class State, int D, class S>
  MPM_HD static S advance(const Constants& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    using T = scalar_of<S>;
    const G f = advanced(G::identity(), L, dt);
    state.volume_ratio = state.volume_ratio * determinant(f);
    const Sym<D, S> b = unimodular(pushed(f, state.elastic_left_cauchy_green));

    const S mean = trace(b) * real<S>(1.0 / 3.0);
    Sym<D, S> d = deviator(b);
    const S stress_norm = c.mu * sqrt(squared_norm(d));
    const T root_two_thirds = real<S>(0.816496580927726);
    const auto& law = during_step(c.hardening, state, dt);
    const S overstress = stress_norm - root_two_thirds * law.yield_stress(state.equivalent_plastic_strain);
    const auto yields = overstress > real<S>(0);
    if (!any(yields)) {
      state.elastic_left_cauchy_green = b;
      return S(real<S>(0));
    }
    const S two_mu_bar = real<S>(2) * c.mu * mean;
    const S multiplier =
        plastic_multiplier(law, overstress, stress_norm, two_mu_bar, state.equivalent_plastic_strain, dt, yields);
    const S shrink = real<S>(1) - two_mu_bar * multiplier / max(stress_norm, S(real<S>(1e-30)));
    for (int k = 0; k < Sym<D, S>::size; ++k) d.s[k] = shrink * d.s[k];
    const S new_mean = select(yields, unimodular_mean(d, mean), mean);
    const S conjugate = mean * conjugate_factor(d, new_mean);
    for (int i = 0; i < 3; ++i) d.s[i] = d.s[i] + new_mean;
    // d + mean rounds: a particle that does not yield keeps b itself, whichever particles share its pack.
    for (int k = 0; k < Sym<D, S>::size; ++k) state.elastic_left_cauchy_green.s[k] = select(yields, d.s[k], b.s[k]);
    state.equivalent_plastic_strain = state.equivalent_plastic_strain + root_two_thirds * multiplier;
    return select(yields, shrink * stress_norm * multiplier * conjugate, S(real<S>(0)));
  }

  /// tau = mu dev(b_e) + K J u' I.
  template <class Constants, template <int, class> class State, int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants& c, const State<D, S>& state) {
    Sym<D, S> tau = deviator(state.elastic_left_cauchy_green);
    const S pressure = c.bulk * volumetric_stress(c.volumetric, state.volume_ratio);
    for (int k = 0; k < Sym<D, S>::size; ++k) tau.s[k] = c.mu * tau.s[k];
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] + pressure;
    return tau;
  }

  template <class Constants, template <int, class> class State, int D, class S>
  MPM_HD static S stored_energy(const Constants& c, const State<D, S>& state) {
    return real<S>(0.5) * c.mu * (trace(state.elastic_left_cauchy_green) - real<S>(3)) +
           c.bulk * volumetric_energy(c.volumetric, state.volume_ratio);
  }

  template <class Constants, template <int, class> class State, int D, class S>
  MPM_HD static S wave_speed(const Constants& c, const State<D, S>& state) {
    return sqrt(c.inverse_density *
                split_tangent(c.volumetric, c.mu, c.bulk, state.elastic_left_cauchy_green, state.volume_ratio));
  }

  template <template <int, class> class State, int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return state.volume_ratio;
  }
};

}  // namespace mpm

/// The state table of a material that is a J2Plasticity.
#define MPM_J2_STATE                                                                                             \
  {"elastic_left_cauchy_green", "", "isochoric elastic left Cauchy-Green tensor, det = 1", MPM_STATE_SYMMETRIC,  \
   MPM_INITIAL_IDENTITY},                                                                                        \
      {"volume_ratio", "", "total J = det F", MPM_STATE_SCALAR, MPM_INITIAL_ONE}, {                              \
    "equivalent_plastic_strain", "", "accumulated equivalent plastic strain", MPM_STATE_SCALAR, MPM_INITIAL_ZERO \
  }
