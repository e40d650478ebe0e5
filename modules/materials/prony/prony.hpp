#pragma once
// Generalised Maxwell solid: an equilibrium spring and two Maxwell branches beside it, of which the shear relaxes and
// the volume does not. Structure as in Simo, Comput. Methods Appl. Mech. Engrg. 60 (1987) 153, and Simo & Hughes (1998),
// sec. 10.3; each branch is a Neo-Hookean network that breaks and reforms (Green & Tobolsky, J. Chem. Phys. 14 (1946)
// 80; Lubliner, Mech. Res. Commun. 12 (1985) 93; Linder, Tkachuk & Miehe, J. Mech. Phys. Solids 59 (2011) 2134):
//   tau = mu dev(b') + sum G_i dev(A_i) + K J u' I,   b' = J^-2/3 b
//   dA_i/dt = L' A_i + A_i L'^T - (A_i - I)/t_i,      L' = L - tr(L)/3 I
// Energy mu/2 (tr b' - 3) + K u(J) + sum G_i/2 (tr A_i - 3 - ln det A_i); a branch dissipates
// G_i/(2 t_i) tr(A_i + A_i^-1 - 2 I). The A_i are spatial and pushed forward by each step, so they turn with the
// particle. The stress of a step strain at any stretch is dev(b') (mu + sum G_i exp(-t/t_i)), that of Simo's model.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/viscosity.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Prony {
  struct Parameters {
    double shear_modulus, bulk_modulus, density, branch_modulus_1, relaxation_time_1, branch_modulus_2,
        relaxation_time_2, volumetric_energy;
  };
  static constexpr int branches = 2;
  template <class T>
  struct Constants {
    T mu, bulk, inverse_density, modulus[branches], inverse_time[branches];
    VolumetricEnergy volumetric;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(p.shear_modulus)),
          bulk(T(p.bulk_modulus)),
          inverse_density(T(1 / p.density)),
          modulus{T(p.branch_modulus_1), T(p.branch_modulus_2)},
          inverse_time{T(1 / p.relaxation_time_1), T(1 / p.relaxation_time_2)},
          volumetric(static_cast<VolumetricEnergy>(static_cast<int>(p.volumetric_energy))) {}
  };

  /// The state: `Gradient` is a Mat, or in axisymmetric scenes a Deformation.
  template <class Gradient>
  struct PronyState {
    Gradient deformation_gradient;
    Sym<Gradient::dimension, typename Gradient::Scalar> branch[branches];  ///< A_i, positive definite
  };
  template <int D, class S>
  using State = PronyState<Mat<D, S>>;
  template <class S>
  using AxisymmetricState = PronyState<Deformation<2, S>>;

  /// Returns the energy dissipated in the branches, J/m^3; never negative.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, PronyState<G>& state) {
    constexpr int D = G::dimension;
    state.deformation_gradient = advanced(state.deformation_gradient, L, dt);
    const G f = advanced(G::identity(), L, dt);
    const S scale = exp(real<S>(-2.0 / 3.0) * log(determinant(f)));  // of the isochoric f' b f'^T
    Sym<D, S> strain = strain_rate(L, dt);
    for (int k = 0; k < Sym<D, S>::size; ++k) strain.s[k] = scale * (dt * strain.s[k]);
    for (int i = 0; i < 3; ++i) strain.s[i] = strain.s[i] + (scale - real<S>(1));
    S heat = S(real<S>(0));
    for (int i = 0; i < branches; ++i) {
      const Relaxation<scalar_of<S>> relaxation(dt * c.inverse_time[i]);
      const Sym<D, S> before = state.branch[i];
      Sym<D, S> convected = pushed(f, before);
      for (int k = 0; k < Sym<D, S>::size; ++k) convected.s[k] = scale * convected.s[k];
      state.branch[i] = relaxed(convected, strain, relaxation);
      heat = heat + c.modulus[i] * network_heat(before, state.branch[i], relaxation);
    }
    return real<S>(0.5) * heat;
  }

  /// mu b' + sum G_i A_i, whose deviator is the stress of the springs.
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> springs(const Constants<scalar_of<S>>& c, const PronyState<G>& state, S J) {
    Sym<G::dimension, S> sum = isochoric(left_cauchy_green(state.deformation_gradient), J);
    for (int k = 0; k < Sym<G::dimension, S>::size; ++k) {
      sum.s[k] = c.mu * sum.s[k];
      for (int i = 0; i < branches; ++i) sum.s[k] = sum.s[k] + c.modulus[i] * state.branch[i].s[k];
    }
    return sum;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const PronyState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    Sym<G::dimension, S> tau = deviator(springs(c, state, J));
    const S pressure = c.bulk * volumetric_stress(c.volumetric, J);
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] + pressure;
    return tau;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const PronyState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    S shear = c.mu * (trace(isochoric(left_cauchy_green(state.deformation_gradient), J)) - real<S>(3));
    for (int i = 0; i < branches; ++i) shear = shear + c.modulus[i] * network_energy(state.branch[i]);
    return real<S>(0.5) * shear + c.bulk * volumetric_energy(c.volumetric, J);
  }

  /// The fastest wave of the instant, before any branch relaxes: that of the split Neo-Hookean solid whose mu b' is the
  /// sum of all springs (the formula holds for tensors of any determinant).
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const PronyState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    return sqrt(c.inverse_density * split_tangent(c.volumetric, scalar_of<S>(1), c.bulk, springs(c, state, J), J));
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const PronyState<G>& state) {
    return determinant(state.deformation_gradient);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_OBJECTIVE | MPM_DISSIPATES;
  static constexpr mpm_dissipation_cause dissipates_by = MPM_VISCOUS_FLOW;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(shear_modulus, "Pa", required, 0.0, unbounded, 0,
                           "mu, shear modulus after all relaxation; 0 is a liquid"),
      MPM_NUMBER_PARAMETER(bulk_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "bulk modulus K, which does not relax"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_NUMBER_PARAMETER(branch_modulus_1, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "G_1, what the first branch adds to the shear modulus at once"),
      MPM_NUMBER_PARAMETER(relaxation_time_1, "s", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "t_1, in which the first branch's stress falls by e"),
      MPM_NUMBER_PARAMETER(branch_modulus_2, "Pa", required, 0.0, unbounded, 0, "G_2 of the second branch"),
      MPM_NUMBER_PARAMETER(relaxation_time_2, "s", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "t_2 of the second branch"),
      MPM_CHOICE_PARAMETER(volumetric_energy, "logarithmic|quadratic|simo", 2, "u(J), see neo_hookean"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
      {"branch_1", "", "isochoric conformation A_1 of the first branch", MPM_STATE_SYMMETRIC, MPM_INITIAL_IDENTITY},
      {"branch_2", "", "isochoric conformation A_2 of the second branch", MPM_STATE_SYMMETRIC, MPM_INITIAL_IDENTITY},
  };
#endif
};

}  // namespace mpm
