#pragma once
// Fixed corotated solid: psi = mu |F - R|^2 + lambda/2 (J - 1)^2, R the rotation of F's polar decomposition. Stomakhin,
// Howes, Schroeder & Teran (2012), Energetically consistent invertible elasticity: the fixed corotated energy.
//   P = 2 mu (F - R) + lambda (J - 1) J F^-T,   tau = P F^T = 2 mu (F - R) F^T + lambda (J - 1) J I
// In 2-D z is a principal direction: a stretch F_zz there adds tau_zz = 2 mu (F_zz - 1) F_zz + lambda (J - 1) J. In
// plane strain F_zz = 1.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/polar.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct FixedCorotated : ElasticSolid {
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

  /// The difference F - R, which is of the size of the strain, so that little is lost where strains are small.
  template <int D, class S>
  MPM_HD static Mat<D, S> distortion(const Mat<D, S>& F) {
    Mat<D, S> r = nearest_rotation(F);
    for (int k = 0; k < D * D; ++k) r.m[k] = F.m[k] - r.m[k];
    return r;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    constexpr int D = G::dimension;
    const Mat<D, S>& F = in_plane(state.deformation_gradient);
    const S J = determinant(state.deformation_gradient), pressure = c.lambda * ((J - real<S>(1)) * J);
    const Mat<D, S> H = distortion(F);
    const scalar_of<S> two_mu = real<S>(2) * c.mu;
    Sym<D, S> tau{};
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) {
        S t = H(i, 0) * F(j, 0);
        for (int k = 1; k < D; ++k) t = t + H(i, k) * F(j, k);
        tau(i, j) = two_mu * t;
      }
    if constexpr (has_zz<G>) {
      const S zz = state.deformation_gradient.zz;
      tau.s[2] = two_mu * ((zz - real<S>(1)) * zz);
    }
    for (int i = 0; i < 3; ++i) tau.s[i] = tau.s[i] + pressure;
    return tau;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S change = determinant(state.deformation_gradient) - real<S>(1);
    constexpr int D = G::dimension;
    const Mat<D, S> H = distortion(in_plane(state.deformation_gradient));
    S squared = H.m[0] * H.m[0];
    for (int k = 1; k < D * D; ++k) squared = squared + H.m[k] * H.m[k];
    if constexpr (has_zz<G>) {
      const S hoop = state.deformation_gradient.zz - real<S>(1);
      squared = squared + hoop * hoop;
    }
    return c.mu * squared + real<S>(0.5) * c.lambda * (change * change);
  }

  /// Along F + s a (x) F^T n, a and n unit vectors, J is linear in s and tr(R^T F), a sum of singular values, convex
  /// where J > 0: rho0 c^2 = d2 psi/ds2 <= 2 mu n.b.n + lambda J^2 (a.n)^2. The longitudinal wave along the largest
  /// stretch attains it, so rho0 c^2 = 2 mu max(n.b.n) + lambda J^2 is exact but for the bound of the eigenvalue in
  /// 3-D.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S J = determinant(state.deformation_gradient);
    const S largest = largest_in_space(left_cauchy_green(state.deformation_gradient));
    return sqrt(c.inverse_density * (real<S>(2) * c.mu * largest + c.lambda * (J * J)));
  }

  /// The largest n.b.n with n in the space of D dimensions; in 3-D an upper bound of it.
  template <class S>
  MPM_HD static S largest_in_space(const Sym<2, S>& b) {
    const S mean = real<S>(0.5) * (b.s[0] + b.s[1]), half = real<S>(0.5) * (b.s[0] - b.s[1]);
    return mean + sqrt(half * half + b.s[3] * b.s[3]);
  }
  template <class S>
  MPM_HD static S largest_in_space(const Sym<3, S>& b) {
    return largest_eigenvalue_bound(b);
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM,
                           "Young's modulus at small strain"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio at small strain"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
  };
#endif
};

}  // namespace mpm
