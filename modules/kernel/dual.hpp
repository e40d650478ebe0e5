#pragma once
// Dual numbers a + b e with e^2 = 0 over a scalar S (double, lanes): a functor that runs over them gives, beside its
// values, their exact derivative in one direction. Griewank & Walther (2008), Evaluating Derivatives, ch. 3.
//
// Decisions follow the values: select(), min(), max() and abs() take the derivative of the chosen side. At zero sqrt()
// has no derivative; zero is taken there, so that the norm of a vector that vanishes has one.

#include "kernel/polar.hpp"
#include "kernel/svd.hpp"

namespace mpm {

/// Whether two types are the same, where no system header can be seen.
template <class A, class B>
inline constexpr bool is_same_type = false;
template <class A>
inline constexpr bool is_same_type<A, A> = true;

template <class S>
struct Dual {
  using Plain = scalar_of<S>;

  S value, derivative;

  Dual() = default;
  MPM_HD Dual(Plain x) : value(x), derivative(Plain(0)) {}
  MPM_HD Dual(S x) requires(!is_same_type<S, Plain>) : value(x), derivative(Plain(0)) {}
  MPM_HD Dual(S x, S dx) : value(x), derivative(dx) {}

  MPM_HD friend Dual operator+(Dual a, Dual b) { return {a.value + b.value, a.derivative + b.derivative}; }
  MPM_HD friend Dual operator-(Dual a, Dual b) { return {a.value - b.value, a.derivative - b.derivative}; }
  MPM_HD friend Dual operator*(Dual a, Dual b) {
    return {a.value * b.value, a.value * b.derivative + a.derivative * b.value};
  }
  MPM_HD friend Dual operator/(Dual a, Dual b) {
    const S ratio = a.value / b.value;
    return {ratio, (a.derivative - ratio * b.derivative) / b.value};
  }
  MPM_HD friend Dual operator+(Dual a, Plain b) { return {a.value + b, a.derivative}; }
  MPM_HD friend Dual operator-(Dual a, Plain b) { return {a.value - b, a.derivative}; }
  MPM_HD friend Dual operator*(Dual a, Plain b) { return {a.value * b, a.derivative * b}; }
  MPM_HD friend Dual operator/(Dual a, Plain b) { return {a.value / b, a.derivative / b}; }
  MPM_HD friend Dual operator+(Plain a, Dual b) { return {a + b.value, b.derivative}; }
  MPM_HD friend Dual operator-(Plain a, Dual b) { return {a - b.value, -b.derivative}; }
  MPM_HD friend Dual operator*(Plain a, Dual b) { return {a * b.value, a * b.derivative}; }
  MPM_HD friend Dual operator/(Plain a, Dual b) {
    const S ratio = a / b.value;
    return {ratio, -(ratio * b.derivative) / b.value};
  }
  MPM_HD friend Dual operator-(Dual a) { return {-a.value, -a.derivative}; }
  MPM_HD Dual& operator+=(Dual b) { return *this = *this + b; }
  MPM_HD Dual& operator-=(Dual b) { return *this = *this - b; }
  MPM_HD Dual& operator*=(Dual b) { return *this = *this * b; }

  MPM_HD friend auto operator<(Dual a, Dual b) { return a.value < b.value; }
  MPM_HD friend auto operator>(Dual a, Dual b) { return a.value > b.value; }
  MPM_HD friend auto operator<=(Dual a, Dual b) { return a.value <= b.value; }
  MPM_HD friend auto operator>=(Dual a, Dual b) { return a.value >= b.value; }
  MPM_HD friend auto operator<(Dual a, Plain b) { return a.value < b; }
  MPM_HD friend auto operator>(Dual a, Plain b) { return a.value > b; }
  MPM_HD friend auto operator<=(Dual a, Plain b) { return a.value <= b; }
  MPM_HD friend auto operator>=(Dual a, Plain b) { return a.value >= b; }

  /// `a` where the mask holds, else `b`.
  template <class Mask>
  MPM_HD friend Dual select(const Mask& mask, Dual a, Dual b) {
    return {select(mask, a.value, b.value), select(mask, a.derivative, b.derivative)};
  }
  MPM_HD friend Dual min(Dual a, Dual b) { return select(a.value < b.value, a, b); }
  MPM_HD friend Dual max(Dual a, Dual b) { return select(a.value > b.value, a, b); }
  MPM_HD friend Dual abs(Dual a) { return select(a.value < Plain(0), -a, a); }
  MPM_HD friend Dual floor(Dual a) { return {floor(a.value), S(Plain(0))}; }
  MPM_HD friend Dual sqrt(Dual a) {
    const S root = sqrt(a.value);
    const auto positive = root > Plain(0);
    const S slope = Plain(0.5) / select(positive, root, S(Plain(1)));
    return {root, select(positive, slope * a.derivative, S(Plain(0)))};
  }
  MPM_HD friend Dual log(Dual a) { return {log(a.value), a.derivative / a.value}; }
  MPM_HD friend Dual exp(Dual a) {
    const S power = exp(a.value);
    return {power, power * a.derivative};
  }
};

template <class S>
struct scalar_of_trait<Dual<S>> {
  using type = scalar_of<S>;
};

template <int D, class S>
MPM_HD Mat<D, S> values_of(const Mat<D, Dual<S>>& a) {
  Mat<D, S> r;
  for (int k = 0; k < D * D; ++k) r.m[k] = a.m[k].value;
  return r;
}
template <int D, class S>
MPM_HD Mat<D, S> derivatives_of(const Mat<D, Dual<S>>& a) {
  Mat<D, S> r;
  for (int k = 0; k < D * D; ++k) r.m[k] = a.m[k].derivative;
  return r;
}
template <int D, class S>
MPM_HD Mat<D, Dual<S>> with_derivatives(const Mat<D, S>& a, const Mat<D, S>& da) {
  Mat<D, Dual<S>> r;
  for (int k = 0; k < D * D; ++k) r.m[k] = Dual<S>(a.m[k], da.m[k]);
  return r;
}
/// A^T B.
template <int D, class S>
MPM_HD Mat<D, S> transposed_product(const Mat<D, S>& a, const Mat<D, S>& b) {
  Mat<D, S> r;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      S t = a(0, i) * b(0, j);
      for (int k = 1; k < D; ++k) t = t + a(k, i) * b(k, j);
      r(i, j) = t;
    }
  return r;
}

// ---- decompositions ----------------------------------------------------------------------------------------------
// Their iterations end by the values alone, so that a derivative carried through them may be cut off early, and at
// equal singular values it would be lost. It is therefore put together from the result.

/// The rotation R of F = R P. Its derivative is dR = R W with W P + P W = R^T dF - dF^T R (W skew), and is not unique
/// where R is not.
template <class S>
MPM_HD Mat<2, Dual<S>> nearest_rotation(const Mat<2, Dual<S>>& F) {
  const Mat<2, S> value = values_of(F), R = nearest_rotation(value);
  const Mat<2, S> P = transposed_product(R, value), M = transposed_product(R, derivatives_of(F));
  const S spin = (M(1, 0) - M(0, 1)) / (P(0, 0) + P(1, 1));
  return with_derivatives(R, R * Mat<2, S>{{S(real<S>(0)), -spin, spin, S(real<S>(0))}});
}
template <class S>
MPM_HD Mat<3, Dual<S>> nearest_rotation(const Mat<3, Dual<S>>& F) {
  const Mat<3, S> value = values_of(F), R = nearest_rotation(value);
  const Mat<3, S> P = transposed_product(R, value), M = transposed_product(R, derivatives_of(F));
  // Both sides as axial vectors: (tr(P) I - P) spin = axial(M - M^T).
  const S trace = P(0, 0) + P(1, 1) + P(2, 2);
  Mat<3, S> A;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) A(i, j) = (i == j ? trace - P(i, j) : -(real<S>(0.5) * (P(i, j) + P(j, i))));
  const Mat<3, S> cofactors = polar::cofactor(A);  // symmetric, as its argument is
  const S inverse = real<S>(1) / (A(0, 0) * cofactors(0, 0) + A(0, 1) * cofactors(0, 1) + A(0, 2) * cofactors(0, 2));
  const Vec<3, S> axial{{M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1)}};
  Vec<3, S> spin;
  for (int i = 0; i < 3; ++i)
    spin[i] = inverse * (cofactors(i, 0) * axial[0] + cofactors(i, 1) * axial[1] + cofactors(i, 2) * axial[2]);
  const S zero = S(real<S>(0));
  return with_derivatives(R,
                          R * Mat<3, S>{{zero, -spin[2], spin[1], spin[2], zero, -spin[0], -spin[1], spin[0], zero}});
}

namespace svd {

/// Singular values so near that the directions between them have no derivative are put apart by sqrt(epsilon) of the
/// largest. What a function of a matrix takes from them, differences of f over differences of the values, has a limit
/// there, which this meets to sqrt(epsilon) (Miehe, Commun. Numer. Methods Engrg. 9 (1993) 889:
/// perturbed eigenvalues). `values` descend.
template <int D, class S>
MPM_HD void put_apart(Vec<D, S>& values) {
  const S least = (sizeof(scalar_of<S>) == 4 ? real<S>(3.5e-4) : real<S>(1.5e-8)) * values[0];
  for (int i = D - 2; i >= 0; --i) values[i] = max(values[i], values[i + 1] + least);
}

}  // namespace svd

/// The decomposition of A + e dA. With M = U^T dA V the values change by M's diagonal, and U and V turn by what solves
/// its off-diagonal.
template <int D, class S>
MPM_HD SingularValues<D, Dual<S>> singular_value_decomposition(const Mat<D, Dual<S>>& A) {
  SingularValues<D, S> plain = singular_value_decomposition(values_of(A));
  svd::put_apart(plain.values);
  const Mat<D, S> M = transposed_product(plain.U, derivatives_of(A) * plain.V);
  Mat<D, S> left{}, right{};  // U^T dU and V^T dV, skew
  for (int i = 0; i < D - 1; ++i)
    for (int j = i + 1; j < D; ++j) {
      const S a = plain.values[i], b = plain.values[j], inverse = real<S>(1) / (b * b - a * a);
      left(i, j) = inverse * (b * M(i, j) + a * M(j, i));
      right(i, j) = inverse * (a * M(i, j) + b * M(j, i));
      left(j, i) = -left(i, j), right(j, i) = -right(i, j);
    }
  SingularValues<D, Dual<S>> r;
  r.U = with_derivatives(plain.U, plain.U * left);
  r.V = with_derivatives(plain.V, plain.V * right);
  for (int i = 0; i < D; ++i) r.values[i] = Dual<S>(plain.values[i], M(i, i));
  return r;
}

template <int D, class S>
MPM_HD LeftStretches<D, Dual<S>> left_stretches(const Mat<D, Dual<S>>& A) {
  const SingularValues<D, Dual<S>> parts = singular_value_decomposition(A);
  LeftStretches<D, Dual<S>> r;
  r.U = parts.U;
  for (int i = 0; i < D; ++i) r.stretch[i] = abs(parts.values[i]);
  return r;
}

}  // namespace mpm
