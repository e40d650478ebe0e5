#pragma once
// What several materials share: moduli, the three volumetric energies, isochoric parts, and tensors made of their
// principal values.

#include "kernel/tensor.hpp"

namespace mpm {

/// Volumetric energies U(J) = modulus * u(J). Only `simo` is stiff at both ends: its tangent grows as J -> 0 and as J
/// -> infinity.
enum class VolumetricEnergy {
  logarithmic = 0,  ///< (ln J)^2 / 2
  quadratic = 1,    ///< (J-1)^2 / 2
  simo = 2          ///< ((J^2-1)/2 - ln J) / 2
};

/// The volumetric energy u(J) over its modulus.
template <class S>
MPM_HD S volumetric_energy(VolumetricEnergy form, S J) {
  const scalar_of<S> half = real<S>(0.5), one = real<S>(1);
  if (form == VolumetricEnergy::logarithmic) {
    const S l = log(J);
    return half * l * l;
  }
  if (form == VolumetricEnergy::quadratic) return half * (J - one) * (J - one);
  return half * (half * (J * J - one) - log(J));
}

/// J u'(J): the Kirchhoff pressure over the modulus, positive in tension.
template <class S>
MPM_HD S volumetric_stress(VolumetricEnergy form, S J) {
  const scalar_of<S> half = real<S>(0.5), one = real<S>(1);
  if (form == VolumetricEnergy::logarithmic) return log(J);
  if (form == VolumetricEnergy::quadratic) return J * (J - one);
  return half * (J * J - one);
}

/// J^2 u''(J): the volumetric part of rho0 c^2 over the modulus; negative beyond J = e for `logarithmic`.
template <class S>
MPM_HD S volumetric_tangent(VolumetricEnergy form, S J) {
  const scalar_of<S> half = real<S>(0.5), one = real<S>(1);
  if (form == VolumetricEnergy::logarithmic) return one - log(J);
  if (form == VolumetricEnergy::quadratic) return J * J;
  return half * (J * J + one);
}

/// Lame and bulk moduli (Pa) from Young's modulus and Poisson's ratio.
MPM_HD double shear_modulus(double youngs_modulus, double poisson_ratio) {
  return youngs_modulus / (2 * (1 + poisson_ratio));
}
MPM_HD double lame_lambda(double youngs_modulus, double poisson_ratio) {
  return youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
}
MPM_HD double bulk_modulus(double youngs_modulus, double poisson_ratio) {
  return youngs_modulus / (3 * (1 - 2 * poisson_ratio));
}

/// The isochoric left Cauchy-Green tensor J^-2/3 b, whose determinant is 1 (Flory 1961; Simo & Hughes 1998, sec. 9.2).
template <int D, class S>
MPM_HD Sym<D, S> isochoric(Sym<D, S> b, S J) {
  const S scale = exp(real<S>(-2.0 / 3.0) * log(J));
  for (int k = 0; k < Sym<D, S>::size; ++k) b.s[k] = scale * b.s[k];
  return b;
}

/// The cofactors det(a) a^-1 of a symmetric tensor of space; their trace is its second invariant.
template <class S>
MPM_HD Sym<2, S> cofactors(const Sym<2, S>& a) {
  const S &x = a.s[0], &y = a.s[1], &z = a.s[2], &xy = a.s[3];
  return {{y * z, x * z, x * y - xy * xy, -(xy * z)}};
}
template <class S>
MPM_HD Sym<3, S> cofactors(const Sym<3, S>& a) {
  const S &x = a.s[0], &y = a.s[1], &z = a.s[2], &yz = a.s[3], &xz = a.s[4], &xy = a.s[5];
  return {{y * z - yz * yz, x * z - xz * xz, x * y - xy * xy, xz * xy - x * yz, xy * yz - y * xz, xz * yz - z * xy}};
}

/// The largest n.a.n with unit vectors n in the space of D dimensions; in 3-D an upper bound of it.
template <class S>
MPM_HD S largest_in_space(const Sym<2, S>& a) {
  const S mean = real<S>(0.5) * (a.s[0] + a.s[1]), half = real<S>(0.5) * (a.s[0] - a.s[1]);
  return mean + sqrt(half * half + a.s[3] * a.s[3]);
}
template <class S>
MPM_HD S largest_in_space(const Sym<3, S>& a) {
  return largest_eigenvalue_bound(a);
}

/// The symmetric tensor U diag(values) U^T of space; in 2-D the third value is that of z.
template <int D, class S>
MPM_HD Sym<D, S> from_principal(const Mat<D, S>& U, const Vec<3, S>& values) {
  Sym<D, S> r;
  r.s[2] = values[2];  // zz in 2-D; written over below in 3-D
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j) {
      S t = U(i, 0) * values[0] * U(j, 0);
      for (int k = 1; k < D; ++k) t = t + U(i, k) * values[k] * U(j, k);
      r(i, j) = t;
    }
  return r;
}

/// rho0 c^2 of the fastest wave along the axes of b, split Neo-Hookean (Simo & Hughes 1998, eq. 9.2.6 with n n n n):
/// longitudinal K J^2 u'' + mu (5/9 tr b - 1/3 n.b.n), or shear mu n.b.n, whichever is larger. `b` is isochoric, and
/// `volumetric` is K J^2 u''.
template <int D, class S>
MPM_HD S split_tangent(const S& volumetric, scalar_of<S> mu, const Sym<D, S>& b) {
  const S mean = trace(b) * real<S>(1.0 / 3.0);
  const S spread = real<S>(0.816496580927726) * sqrt(squared_norm(deviator(b)));
  const S smallest = max(mean - spread, S(real<S>(0)));
  const S longitudinal = volumetric + mu * (real<S>(5.0 / 3.0) * mean - real<S>(1.0 / 3.0) * smallest);
  return max(longitudinal, mu * (mean + spread));
}
template <int D, class S>
MPM_HD S split_tangent(VolumetricEnergy form, scalar_of<S> mu, scalar_of<S> bulk, const Sym<D, S>& b, S J) {
  return split_tangent(bulk * volumetric_tangent(form, J), mu, b);
}

}  // namespace mpm
