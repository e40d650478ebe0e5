#pragma once
// Compressible Neo-Hookean solids in two named forms and three volumetric energies u(J) (kernel/elasticity.hpp):
//   coupled  psi = mu/2 (tr b - 3 - 2 ln J) + lambda u(J),   tau = mu (b - I) + lambda J u' I
//   split    psi = mu/2 (J^-2/3 tr b - 3) + K u(J),          tau = mu dev(J^-2/3 b) + K J u' I
// The coupled form is that of Ogden (1984), sec. 7.2.3; the split one that of Simo & Hughes (1998), eq. 9.2.3.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct NeoHookean : ElasticSolid {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density, form, volumetric_energy;
  };
  template <class T>
  struct Constants {
    T mu, modulus, inverse_density;  ///< `modulus` is lambda of `coupled` or K of `split`
    bool split;
    VolumetricEnergy volumetric;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          modulus(T(p.form != 0 ? bulk_modulus(p.youngs_modulus, p.poisson_ratio)
                                : lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)),
          split(p.form != 0),
          volumetric(static_cast<VolumetricEnergy>(static_cast<int>(p.volumetric_energy))) {}
  };

  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    Sym<G::dimension, S> tau = left_cauchy_green(state.deformation_gradient);
    S pressure = c.modulus * volumetric_stress(c.volumetric, J);
    if (c.split)
      tau = deviator(isochoric(tau, J));
    else
      pressure = pressure - c.mu;
    for (int k = 0; k < Sym<G::dimension, S>::size; ++k) tau.s[k] = c.mu * tau.s[k];
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] + pressure;
    return tau;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    const Sym<G::dimension, S> b = left_cauchy_green(state.deformation_gradient);
    const S volumetric = c.modulus * volumetric_energy(c.volumetric, J);
    const scalar_of<S> half_mu = real<S>(0.5) * c.mu;
    if (c.split) return volumetric + half_mu * (trace(isochoric(b, J)) - real<S>(3));
    return volumetric + half_mu * (trace(b) - real<S>(3) - real<S>(2) * log(J));
  }

  /// The fastest wave. Longitudinal waves have rho0 c^2 = mu (1 + n.b.n) + lambda J^2 u'' (coupled); the result is
  /// never below the shear wave's mu n.b.n.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    const Sym<G::dimension, S> b = left_cauchy_green(state.deformation_gradient);
    if (c.split) {
      return sqrt(c.inverse_density * split_tangent(c.volumetric, c.mu, c.modulus, isochoric(b, J), J));
    }
    const S largest = largest_eigenvalue_bound(b);
    const S longitudinal = c.mu * (largest + real<S>(1)) + c.modulus * volumetric_tangent(c.volumetric, J);
    return sqrt(c.inverse_density * max(longitudinal, c.mu * largest));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
      MPM_CHOICE_PARAMETER(form, "coupled|split", 0,
                           "coupled: mu/2 (tr b - 3 - 2 ln J) + lambda u(J); split: isochoric part + K u(J)"),
      MPM_CHOICE_PARAMETER(
          volumetric_energy, "logarithmic|quadratic|simo", 0,
          "u(J): (ln J)^2/2, (J-1)^2/2, or ((J^2-1)/2 - ln J)/2, the only one stiff when crushed and when stretched"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
  };
#endif
};

}  // namespace mpm
