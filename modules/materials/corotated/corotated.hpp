#pragma once
// Linear corotated solid: psi = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2, R the rotation of F's polar decomposition.
// Mueller & Gross (2004), Interactive virtual materials, Graphics Interface; Sifakis & Barbic (2012), FEM simulation of
// 3D deformable solids, SIGGRAPH course, sec. 3.4.
//   P = 2 mu (F - R) + lambda tr(R^T F - I) R,   tau = P F^T = 2 mu (F - R) F^T + lambda tr(R^T F - I) V,   V = R F^T
// The trace is that of the stretch: sum (s_i - 1), where the fixed corotated law has J - 1. In 2-D z is a principal
// direction: a stretch F_zz there adds F_zz - 1 to the trace and tau_zz = 2 mu (F_zz - 1) F_zz + lambda tr F_zz.

#include "kernel/elasticity.hpp"
#include "kernel/functor.hpp"
#include "kernel/polar.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Corotated : ElasticSolid {
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

  /// R, F - R and the trace of R^T F - I, which are of the size of the strain: little is lost where strains are small.
  template <int D, class S>
  struct Stretch {
    Mat<D, S> rotation, distortion;
    S trace;
  };
  template <class G, class S = typename G::Scalar>
  MPM_HD static Stretch<G::dimension, S> prepared_stretch(const G& gradient) {
    constexpr int D = G::dimension;
    const Mat<D, S>& F = in_plane(gradient);
    Stretch<D, S> p;
    p.rotation = nearest_rotation(F);
    p.trace = S(real<S>(0));
    for (int k = 0; k < D * D; ++k) {
      p.distortion.m[k] = F.m[k] - p.rotation.m[k];
      p.trace = p.trace + p.rotation.m[k] * p.distortion.m[k];
    }
    if constexpr (has_zz<G>) p.trace = p.trace + (gradient.zz - real<S>(1));
    return p;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    constexpr int D = G::dimension;
    const Mat<D, S>& F = in_plane(state.deformation_gradient);
    const Stretch<D, S> p = prepared_stretch(state.deformation_gradient);
    const scalar_of<S> two_mu = real<S>(2) * c.mu;
    const S spread = c.lambda * p.trace;
    Mat<D, S> piola;
    for (int k = 0; k < D * D; ++k) piola.m[k] = two_mu * p.distortion.m[k] + spread * p.rotation.m[k];
    Sym<D, S> tau{};
    for (int i = 0; i < D; ++i)
      for (int j = i; j < D; ++j) {
        S t = piola(i, 0) * F(j, 0);
        for (int k = 1; k < D; ++k) t = t + piola(i, k) * F(j, k);
        tau(i, j) = t;
      }
    if constexpr (has_zz<G>) {
      const S zz = state.deformation_gradient.zz;
      tau.s[2] = (two_mu * (zz - real<S>(1)) + spread) * zz;
    } else if constexpr (D == 2) {
      tau.s[2] = spread;
    }
    return tau;
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S stored_energy(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    constexpr int D = G::dimension;
    const Stretch<D, S> p = prepared_stretch(state.deformation_gradient);
    S squared = p.distortion.m[0] * p.distortion.m[0];
    for (int k = 1; k < D * D; ++k) squared = squared + p.distortion.m[k] * p.distortion.m[k];
    if constexpr (has_zz<G>) {
      const S hoop = state.deformation_gradient.zz - real<S>(1);
      squared = squared + hoop * hoop;
    }
    return c.mu * squared + real<S>(0.5) * c.lambda * (p.trace * p.trace);
  }

  /// Along F + s a (x) F^T n, a and n unit vectors, m = V n and x = tr(R^T F), whose second derivative is x'' = sum over
  /// pairs (a_i m_j - a_j m_i)^2/(s_i + s_j) in the principal frame:
  ///   rho0 c^2 = d2 psi/ds2 = 2 mu |m|^2 + lambda (a.m)^2 + K x'',   K = lambda (x - 3) - 2 mu.
  /// With the largest stretch s it is at most 2 mu s^2 + max(lambda s^2, K s, 0), which the longitudinal wave along s
  /// attains unless the solid is much stretched. (By Lagrange's identity (a.m)^2/s + x'' is at most s: of the pairs only
  /// that of the two smaller stretches can have s_i + s_j < s.)
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const ElasticState<G>& state) {
    const S trace = prepared_stretch(state.deformation_gradient).trace, zero = S(real<S>(0));
    const S squared = largest_in_space(left_cauchy_green(state.deformation_gradient));
    const S pull = c.lambda * trace - real<S>(2) * c.mu;
    const S spread = max(max(c.lambda * squared, pull * sqrt(squared)), zero);
    return sqrt(c.inverse_density * (real<S>(2) * c.mu * squared + spread));
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
