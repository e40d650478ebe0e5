#pragma once
// The rotation nearest to a 2 x 2 or 3 x 3 matrix, for stress laws that need it every step: several times faster than
// through the singular values (kernel/svd.hpp), which take over where the closed form loses its digits. It serves
// float, double, lanes and the device pass alike.
//
// 3-D: x = tr(R^T F), the sum of the signed singular values, is the largest root of the quartic
//   (x^2 - I)^2 - 8 J x - 4 II = 0,   I = tr b,  II = (I^2 - tr b^2)/2,  b = F F^T,
// and R = dx/dF (Franca, Comput. Math. Appl. 18 (1989) 459; Lin, Chitalu & Komura, ACM Trans. Graph. 41 (2022),
// Isotropic ARAP energy):
//   R = ((x^2 + I) F + 2 x cof F - 2 b F) / (x^3 - I x - 2 J).
// The denominator is 2 (s1 + s2)(s2 + s3)(s3 + s1): zero where R is not unique, and only there.

#include "kernel/svd.hpp"

namespace mpm {

namespace polar {

/// The relative rounding error of the scalar type behind S.
template <class S>
MPM_HD constexpr scalar_of<S> epsilon() {
  return sizeof(scalar_of<S>) == 4 ? scalar_of<S>(0x1p-23) : scalar_of<S>(0x1p-52);
}

/// cof A = det(A) A^-T.
template <class S>
MPM_HD Mat<3, S> cofactor(const Mat<3, S>& a) {
  Mat<3, S> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
      r(i, j) = a(k, m) * a(l, n) - a(k, n) * a(l, m);
    }
  return r;
}

/// The largest root by Halley's method. sqrt(3 I) is at or above it and all four roots are real, so that steps go down
/// only. A lane keeps its root once its step says that the next would not change it, whatever the lanes beside it need.
/// The result is zero where the root is nearly a double one and steps stay slow.
template <class S>
MPM_HD S largest_root(S first, S second, S J) {
  const S zero = S(real<S>(0)), twice = J + J, four_second = real<S>(4) * second;
  S x = sqrt(real<S>(3) * first), active = S(real<S>(1));
  for (int step = 0; step < 12; ++step) {
    // The quartic's value, slope / 4 and curvature / 8.
    const S square = x * x, gap = square - first;
    const S value = gap * gap - (real<S>(4) * (twice * x) + four_second), slope = x * gap - twice;
    const S curvature = real<S>(0.5) * gap + square;
    const S down =
        select(active > real<S>(0.5), value * slope / (real<S>(4) * (slope * slope) - value * curvature), zero);
    x = x - down;
    // The error left is below down^3 (f''/2f')^2, which is not small beside a second root that is near.
    const S left = down * down * abs(down) * (curvature * curvature);
    active = select(left > real<S>(0.25) * epsilon<S>() * x * (slope * slope), active, zero);
    if (!any(active > real<S>(0.5))) break;
  }
  return select(active > real<S>(0.5), zero, x);
}

/// One step of Newton towards the rotation: (A + A^-T)/2 (Higham, SIAM J. Sci. Stat. Comput. 7 (1986) 1160).
template <class S>
MPM_HD Mat<3, S> orthogonalised(const Mat<3, S>& A) {
  Mat<3, S> r = cofactor(A);
  const S half = real<S>(0.5) / (A(0, 0) * r(0, 0) + A(0, 1) * r(0, 1) + A(0, 2) * r(0, 2));
  for (int k = 0; k < 9; ++k) r.m[k] = real<S>(0.5) * A.m[k] + half * r.m[k];
  return r;
}

/// Newton's steps until rounding, where `active` is 1; elsewhere R stays as it is to the last bit.
template <class S>
MPM_HD void orthogonalise(Mat<3, S>& R, S active) {
  for (int step = 0; step < 4 && any(active > real<S>(0.5)); ++step) {
    const Mat<3, S> next = orthogonalised(R);
    S change = S(real<S>(0));
    for (int k = 0; k < 9; ++k) {
      const S d = next.m[k] - R.m[k];
      change = change + d * d;
      R.m[k] = select(active > real<S>(0.5), next.m[k], R.m[k]);
    }
    active = select(change > epsilon<S>(), active, S(real<S>(0)));
  }
}

}  // namespace polar

/// The rotation nearest to F, det +1 whatever the sign of det F: F = R P with P symmetric, and positive where det F >
/// 0. Where two such rotations are equally near (a reflection of equal stretches, zero) it is one of them.
template <class S>
MPM_HD Mat<2, S> nearest_rotation(const Mat<2, S>& F) {
  const S one = S(real<S>(1)), scale = one / svd::largest_entry(F);
  const S c = scale * F(0, 0) + scale * F(1, 1), s = scale * F(1, 0) - scale * F(0, 1);
  const S squared = c * c + s * s;
  const auto unique = squared > svd::smallest_square<S>();
  const S inverse = one / sqrt(select(unique, squared, one));
  const S cosine = select(unique, c * inverse, one), sine = select(unique, s * inverse, S(real<S>(0)));
  return {{cosine, -sine, sine, cosine}};
}

template <class S>
MPM_HD Mat<3, S> nearest_rotation(const Mat<3, S>& F) {
  using T = scalar_of<S>;
  const S one = S(real<S>(1)), zero = S(real<S>(0));
  const Sym<3, S> b = left_cauchy_green(F);
  const S first = trace(b), second = real<S>(0.5) * (first * first - squared_norm(b));
  Mat<3, S> R = polar::cofactor(F);
  const S J = F(0, 0) * R(0, 0) + F(0, 1) * R(0, 1) + F(0, 2) * R(0, 2);
  const S x = polar::largest_root(first, second, J);
  const S divisor = x * (x * x - first) - (J + J);

  // divisor / x^3 says how far R is from not being unique: the ratio is 16/27 at equal stretches and 0 where R is not
  // unique. At a ratio q, rounding of the root shows in R as epsilon / (2 q^2), in the directions that Newton's steps
  // correct, and rounding of R's own sum as epsilon / q. At 0.02 one stretch is 200 times the others, or the particle
  // is nearly a reflection.
  constexpr T uncertain = T(0.02), rounded = T(0.3);
  constexpr T largest = sizeof(T) == 4 ? T(1e4) : T(1e40);  // x^7, which is the most that is formed, stays in range
  const S in_range = select(x < largest, select(x > real<S>(1) / largest, one, zero), zero);
  const S cube = x * x * x;
  const S certain = select(divisor > uncertain * cube, in_range, zero);  // zero for NaN

  const S inverse = one / select(certain > real<S>(0.5), divisor, one), twice = x + x, sum = x * x + first;
  Sym<3, S> weight;  // (x^2 + I) I - 2 b
  for (int k = 0; k < 6; ++k) weight.s[k] = real<S>(-2) * b.s[k];
  for (int i = 0; i < 3; ++i) weight.s[i] = weight.s[i] + sum;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      S t = twice * R(i, j);
      for (int k = 0; k < 3; ++k) t = t + weight(i, k) * F(k, j);
      R(i, j) = t * inverse;
    }
  polar::orthogonalise(R, select(divisor < rounded * cube, certain, zero));
  if (any(certain < real<S>(0.5))) {
    const Mat<3, S> other = polar_rotation(F);
    for (int k = 0; k < 9; ++k) R.m[k] = select(certain > real<S>(0.5), R.m[k], other.m[k]);
  }
  return R;
}

}  // namespace mpm
