#pragma once
// Isochoric left Cauchy-Green tensors b, det b = 1, of laws whose elastic strain is returned to a yield surface: Simo &
// Hughes (1998), Computational Inelasticity, sec. 9.3. After a return tr b follows from det b = 1 (box 9.1 there keeps
// the trial trace, which would store energy that was dissipated).

#include "kernel/tensor.hpp"

namespace mpm {

/// f b f^T; in plane strain f_zz = 1.
template <int D, class S>
MPM_HD Sym<D, S> pushed(const Mat<D, S>& f, const Sym<D, S>& b) {
  Sym<D, S> r = b;
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j) {
      S t = S(real<S>(0));
      for (int k = 0; k < D; ++k)
        for (int l = 0; l < D; ++l) t = t + f(i, k) * b(k, l) * f(j, l);
      r(i, j) = t;
    }
  return r;
}
template <class S>
MPM_HD Sym<2, S> pushed(const Deformation<2, S>& f, const Sym<2, S>& b) {
  Sym<2, S> r = pushed(f.plane, b);
  r.s[2] = f.zz * f.zz * b.s[2];
  return r;
}

/// The tensor det(b)^-1/3 b. It is divided by b's own determinant, not by that of the increments, so that rounding does
/// not pile up over many steps.
template <int D, class S>
MPM_HD Sym<D, S> unimodular(Sym<D, S> b) {
  const S scale = exp(real<S>(-1.0 / 3.0) * log(determinant(b)));
  for (int k = 0; k < Sym<D, S>::size; ++k) b.s[k] = scale * b.s[k];
  return b;
}

/// The mean of tr(b)/3 that makes det(d + t I) = 1 for a deviatoric d: largest root of t^3 - (d:d/2) t + det d - 1.
/// Newton from a start at or above the root is monotone, the cubic being convex there. 2 sqrt(d:d/6) + 1 is no less than
/// the root either, and near it where a large trial was returned to a small d. A lane keeps its root once its step says
/// that the next would not change it, whatever the lanes beside it need: two or three steps for metals, and one for each
/// halving of the way where the root of a large d is nearly a double one.
template <int D, class S>
MPM_HD S unimodular_mean(const Sym<D, S>& d, S start) {
  constexpr auto rounding = scalar_of<S>(sizeof(scalar_of<S>) == 4 ? 0x1p-23 : 0x1p-52);
  const S half_norm = real<S>(0.5) * squared_norm(d), offset = determinant(d) - real<S>(1), norm = sqrt(half_norm);
  // Where the cubic turns: the largest root lies above, but rounding may not.
  const S least = real<S>(0.5773502691896257) * norm;
  // After the first step, which may go up from a start below the root, one that goes up is rounding over a slope that has all
  // but vanished, and would be thrown far away.
  S most = real<S>(1.1547005383792517) * norm + real<S>(1);
  S t = max(min(start, most), least), active = S(real<S>(1));
  for (int iteration = 0; iteration < 100 && any(active > real<S>(0.5)); ++iteration) {
    const S slope = max(real<S>(3) * t * t - half_norm, rounding * half_norm);
    const S next = min(max(t - (t * (t * t - half_norm) + offset) / slope, least), most), down = t - next;
    t = select(active > real<S>(0.5), next, t);
    most = t;
    // What is left of a step of Newton is its square times half of the curvature over the slope.
    active = select(real<S>(3) * down * down > rounding * slope, active, S(real<S>(0)));
  }
  return t;
}

/// The factor -(3 mu / 2) dt / d(shrink of d), over mu |d|^2 / 2, by which the stress that does plastic work differs
/// from |s|. t(d) follows from det(d + t I) = 1, and the factor is 1 + O(elastic strain).
template <int D, class S>
MPM_HD S conjugate_factor(const Sym<D, S>& d, S t) {
  const S norm = max(squared_norm(d), S(real<S>(1e-30)));
  return (t - real<S>(3) * determinant(d) / norm) / (t * t - real<S>(1.0 / 6.0) * norm);
}

}  // namespace mpm
