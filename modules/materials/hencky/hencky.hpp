#pragma once
// St. Venant-Kirchhoff solid with Hencky's strain: psi = mu eps:eps + lambda/2 tr(eps)^2, eps = ln V the logarithm of
// the left stretch. Hencky (1928), Z. techn. Physik 9:215; Anand (1979), J. Appl. Mech. 46:78; in MPM: Klar et al.,
// ACM Trans. Graph. 35 (2016) 103, eq. 24.
//   tau = 2 mu eps + lambda tr(eps) I
// This is exact for any isotropic energy of the principal logarithmic strains: tau_i = d psi / d eps_i.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/hencky.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Hencky : ElasticSolid {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density;
  };
  template <class T>
  struct Constants {
    T mu, lambda, inverse_density;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          inverse_density(T(1 / p.density)) {}
  };

  template <int D, class S>
  using Principal = HenckySolid::Principal<D, S>;

  template <class S>
  MPM_HD static S strain_of_z(const Mat<2, S>&) {
    return S(real<S>(0));
  }
  template <class S>
  MPM_HD static S strain_of_z(const Deformation<2, S>& F) {
    return log(F.zz);
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static Principal<G::dimension, S> prepared(const ElasticState<G>& state) {
    constexpr int D = G::dimension;
    const LeftStretches<D, S> parts = left_stretches(in_plane(state.deformation_gradient));
    Principal<D, S> p;
    p.directions = parts.U;
    for (int i = 0; i < D; ++i) p.strain[i] = log(parts.stretch[i]);
    if constexpr (D == 2) p.strain[2] = strain_of_z(state.deformation_gradient);
    return p;
  }

  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    return HenckySolid::kirchhoff_stress(c, p);
  }

  template <int D, class S>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    return HenckySolid::stored_energy(c, p);
  }

  /// The fastest wave. Along the principal axes longitudinal waves have rho0 c^2 = lambda + 2 mu - tau_i, and shear
  /// waves between strains that differ by x have mu x (1 + coth x); sqrt(1 + x^2) stands for x coth x, which it exceeds
  /// by so little that the sum is 5 % too large at most. Waves askew of the axes are faster where stretches differ.
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const Principal<D, S>& p) {
    const Vec<3, S>& e = p.strain;
    const S least = min(min(e[0], e[1]), e[2]), x = max(max(e[0], e[1]), e[2]) - least, one = S(real<S>(1));
    const S longitudinal = c.lambda + real<S>(2) * c.mu - (real<S>(2) * c.mu * least + c.lambda * (e[0] + e[1] + e[2]));
    const S shear = c.mu * (x + sqrt(x * x + one));
    return sqrt(c.inverse_density * (max(longitudinal, shear) + c.mu * HenckySolid::askew(x)));
  }

  /// Stress, energy and wave speed of a state whose principal strains are not known yet.
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    return kirchhoff_stress(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    return stored_energy(c, prepared(state));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    return wave_speed(c, prepared(state));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus, of the logarithmic strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio, of the logarithmic strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
  };
#endif
};

}  // namespace mpm
