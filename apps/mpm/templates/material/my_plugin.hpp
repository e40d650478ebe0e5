#pragma once
// Compressible Neo-Hookean rubber, b = F F^T, J = det F (Ogden 1984, Non-linear Elastic Deformations, sec. 7.2.3):
//   psi = mu/2 (tr b - 3 - 2 ln J) + lambda/2 ((J^2 - 1)/2 - ln J),   tau = mu (b - I) + lambda/2 (J^2 - 1) I
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif
namespace mpm {
struct MyPlugin : ElasticSolid {  // the particle keeps F, (I + dt L) F after a step, and strain makes no heat
  struct Parameters {             // the rows of the table below, in order
    double shear_modulus, lame_lambda, density;
  };
  template <class T>
  struct Constants {  // made of the parameters once a batch
    T mu, k, rho;     ///< k = lambda/2
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(p.shear_modulus)), k(T(p.lame_lambda / 2)), rho(T(p.density)) {}
  };
  template <class G, class S = typename G::Scalar>  // G: a matrix of D x D, with zz in axisymmetric scenes
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& s) {
    const S J = volume_ratio(s), pressure = c.k * (J * J - real<S>(1)) - c.mu;
    auto tau = left_cauchy_green(s.deformation_gradient);
    for (int i = 0; i < tau.size; ++i) tau.s[i] = i < 3 ? c.mu * tau.s[i] + pressure : c.mu * tau.s[i];
    return tau;
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& s) {
    const S J = volume_ratio(s), half = S(real<S>(0.5));
    const S isotropic = trace(left_cauchy_green(s.deformation_gradient)) - real<S>(3);
    return c.mu * (half * isotropic - log(J)) + c.k * (half * (J * J - real<S>(1)) - log(J));
  }
  /// rho c^2 = mu (1 + n.b.n) + lambda/2 (J^2 + 1), n the direction of largest stretch.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>& s) {
    const S J = volume_ratio(s), stretch = largest_eigenvalue_bound(left_cauchy_green(s.deformation_gradient));
    return sqrt((c.mu * (real<S>(1) + stretch) + c.k * (J * J + real<S>(1))) / c.rho);
  }
#if MPM_HOST
  static constexpr unsigned traits = MPM_HYPERELASTIC | MPM_OBJECTIVE;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(shear_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "mu"),
      MPM_NUMBER_PARAMETER(lame_lambda, "Pa", required, 0.0, unbounded, 0, "lambda = K - 2 mu/3, at least 0 here"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density")};
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY}};
#endif
};
}  // namespace mpm
