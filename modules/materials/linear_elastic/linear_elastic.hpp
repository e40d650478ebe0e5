#pragma once
// Small-strain isotropic elasticity: eps = sym(F) - I, sigma = lambda tr(eps) I + 2 mu eps. The teaching baseline:
// not objective, a rotation by theta makes the false strain (cos theta - 1) I in its plane. Any textbook, e.g.
// Timoshenko & Goodier.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct LinearElastic : ElasticSolid {
  struct Parameters {
    double youngs_modulus, poisson_ratio, density;
  };
  template <class T>
  struct Constants {
    T mu, lambda, longitudinal_speed;
    MPM_HD explicit Constants(const Parameters& p)
        : mu(T(shear_modulus(p.youngs_modulus, p.poisson_ratio))),
          lambda(T(lame_lambda(p.youngs_modulus, p.poisson_ratio))),
          longitudinal_speed(sqrt(T(
              (lame_lambda(p.youngs_modulus, p.poisson_ratio) + 2 * shear_modulus(p.youngs_modulus, p.poisson_ratio)) /
              p.density))) {}
  };

  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> strain(const ElasticState<G>& state) {
    constexpr int D = G::dimension;
    const Mat<D, S>& F = in_plane(state.deformation_gradient);
    Sym<D, S> e{};
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) e(i, j) = real<S>(0.5) * (F(i, j) + F(j, i));
    for (int i = 0; i < D; ++i) e(i, i) = e(i, i) - real<S>(1);
    if constexpr (has_zz<G>) e.s[2] = state.deformation_gradient.zz - real<S>(1);
    return e;
  }

  /// tau = sigma to the order of small strains.
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    constexpr int D = G::dimension;
    Sym<D, S> e = strain(state);
    const S pressure = c.lambda * trace(e);
    for (int k = 0; k < Sym<D, S>::size; ++k) e.s[k] = real<S>(2) * c.mu * e.s[k];
    for (int i = 0; i < 3; ++i) e.s[i] = e.s[i] + pressure;
    return e;
  }

  /// psi = mu eps:eps + lambda/2 (tr eps)^2, J/m^3.
  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const Sym<G::dimension, S> e = strain(state);
    return c.mu * squared_norm(e) + real<S>(0.5) * c.lambda * trace(e) * trace(e);
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>&) {
    return S(c.longitudinal_speed);
  }

#if MPM_HOST
  static constexpr unsigned traits = 0;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(youngs_modulus, "Pa", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "Young's modulus"),
      MPM_NUMBER_PARAMETER(poisson_ratio, "", required, -1.0, 0.5, MPM_ABOVE_MINIMUM | MPM_BELOW_MAXIMUM,
                           "Poisson's ratio"),
      MPM_NUMBER_PARAMETER(density, "kg/m^3", required, 0.0, unbounded, MPM_ABOVE_MINIMUM, "initial density"),
  };
  static constexpr mpm_state state[] = {
      {"deformation_gradient", "", "deformation gradient F", MPM_STATE_PLANE_DEFORMATION, MPM_INITIAL_IDENTITY},
  };
#endif
};

}  // namespace mpm
