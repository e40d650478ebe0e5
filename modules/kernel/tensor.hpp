#pragma once
// Small vectors and matrices over any scalar S (float, double, lanes). Row-major; D is the dimension of space.

#include "kernel/math.hpp"

namespace mpm {

template <int N, class S>
struct Vec {
  S v[N];
  MPM_HD S& operator[](int i) { return v[i]; }
  MPM_HD const S& operator[](int i) const { return v[i]; }
};

template <int D, class S>
struct Mat {
  using Scalar = S;
  static constexpr int dimension = D;
  S m[D * D];
  MPM_HD S& operator()(int i, int j) { return m[i * D + j]; }
  MPM_HD const S& operator()(int i, int j) const { return m[i * D + j]; }
  MPM_HD static Mat identity() {
    Mat r{};
    for (int i = 0; i < D; ++i) r(i, i) = r(i, i) + scalar_of<S>(1);
    return r;
  }
};

/// Symmetric tensor of three-dimensional space: in 2-D (plane strain) it keeps zz. Order: xx yy zz xy | xx yy zz yz xz
/// xy.
template <int D, class S>
struct Sym {
  static constexpr int size = D == 2 ? 4 : 6;
  S s[size];
  MPM_HD static constexpr int index(int i, int j) { return i == j ? i : (D == 2 ? 3 : 6 - i - j); }
  MPM_HD S& operator()(int i, int j) { return s[index(i, j)]; }
  MPM_HD const S& operator()(int i, int j) const { return s[index(i, j)]; }
  MPM_HD static Sym identity() {
    Sym r{};
    for (int i = 0; i < 3; ++i) r.s[i] = r.s[i] + scalar_of<S>(1);
    return r;
  }
};

/// Matrix of three-dimensional space that couples no in-plane axis with z in 2-D (plane strain, or axisymmetric with z
/// around the axis): there xx xy yx yy and zz. Laid out as MPM_STATE_DEFORMATION.
template <int D, class S>
struct Deformation;
template <class S>
struct Deformation<2, S> {
  using Scalar = S;
  static constexpr int dimension = 2;
  Mat<2, S> plane;
  S zz;
  MPM_HD static Deformation identity() { return {Mat<2, S>::identity(), S(scalar_of<S>(1))}; }
};
template <class S>
struct Deformation<3, S> {
  Mat<3, S> plane;  ///< the whole matrix, which in 3-D couples all axes
};

/// Whether a matrix of two dimensions holds zz too; without, its zz is that of plane strain.
template <class Matrix>
inline constexpr bool has_zz = false;
template <class S>
inline constexpr bool has_zz<Deformation<2, S>> = true;

/// The part along the axes of the grid.
template <int D, class S>
MPM_HD const Mat<D, S>& in_plane(const Mat<D, S>& a) {
  return a;
}
template <int D, class S>
MPM_HD const Mat<D, S>& in_plane(const Deformation<D, S>& a) {
  return a.plane;
}

template <int D, class S>
MPM_HD Mat<D, S> operator*(const Mat<D, S>& a, const Mat<D, S>& b) {
  Mat<D, S> r;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      S t = a(i, 0) * b(0, j);
      for (int k = 1; k < D; ++k) t = t + a(i, k) * b(k, j);
      r(i, j) = t;
    }
  return r;
}

template <class S>
MPM_HD S determinant(const Mat<2, S>& a) {
  return a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
}
template <class S>
MPM_HD S determinant(const Mat<3, S>& a) {
  return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)) - a(0, 1) * (a(1, 0) * a(2, 2) - a(1, 2) * a(2, 0)) +
         a(0, 2) * (a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0));
}
template <class S>
MPM_HD S determinant(const Deformation<2, S>& a) {
  return determinant(a.plane) * a.zz;
}

template <class S>
MPM_HD S determinant(const Sym<2, S>& a) {
  return (a(0, 0) * a(1, 1) - a(0, 1) * a(0, 1)) * a.s[2];
}
template <class S>
MPM_HD S determinant(const Sym<3, S>& a) {
  return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(1, 2)) - a(0, 1) * (a(0, 1) * a(2, 2) - a(1, 2) * a(0, 2)) +
         a(0, 2) * (a(0, 1) * a(1, 2) - a(1, 1) * a(0, 2));
}

template <int D, class S>
MPM_HD S trace(const Sym<D, S>& a) {
  return a.s[0] + a.s[1] + a.s[2];
}

/// a : a over the full tensor (off-diagonals counted twice).
template <int D, class S>
MPM_HD S squared_norm(const Sym<D, S>& a) {
  S r = a.s[0] * a.s[0] + a.s[1] * a.s[1] + a.s[2] * a.s[2];
  for (int k = 3; k < Sym<D, S>::size; ++k) r = r + scalar_of<S>(2) * a.s[k] * a.s[k];
  return r;
}

/// a - tr(a)/3 I.
template <int D, class S>
MPM_HD Sym<D, S> deviator(Sym<D, S> a) {
  const S mean = trace(a) * real<S>(1.0 / 3.0);
  for (int i = 0; i < 3; ++i) a.s[i] = a.s[i] - mean;
  return a;
}

/// Left Cauchy-Green tensor F F^T; in plane strain zz = 1.
template <int D, class S>
MPM_HD Sym<D, S> left_cauchy_green(const Mat<D, S>& F) {
  Sym<D, S> b = Sym<D, S>::identity();
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j) {
      S t = F(i, 0) * F(j, 0);
      for (int k = 1; k < D; ++k) t = t + F(i, k) * F(j, k);
      b(i, j) = t;
    }
  return b;
}
template <class S>
MPM_HD Sym<2, S> left_cauchy_green(const Deformation<2, S>& F) {
  Sym<2, S> b = left_cauchy_green(F.plane);
  b.s[2] = F.zz * F.zz;
  return b;
}

/// An upper bound of the largest eigenvalue, tight for axisymmetric tensors: tr/3 + sqrt(2/3) |dev| (Wolkowicz & Styan
/// 1980).
template <int D, class S>
MPM_HD S largest_eigenvalue_bound(const Sym<D, S>& a) {
  return trace(a) * real<S>(1.0 / 3.0) + real<S>(0.816496580927726) * sqrt(squared_norm(deviator(a)));
}

/// (I + dt L) F: the deformation gradient after a step with velocity gradient L.
template <int D, class S>
MPM_HD Mat<D, S> advanced(const Mat<D, S>& F, const Mat<D, S>& L, scalar_of<S> dt) {
  const Mat<D, S> rate = L * F;
  Mat<D, S> r;
  for (int k = 0; k < D * D; ++k) r.m[k] = F.m[k] + dt * rate.m[k];
  return r;
}
template <class S>
MPM_HD Deformation<2, S> advanced(const Deformation<2, S>& F, const Deformation<2, S>& L, scalar_of<S> dt) {
  return {advanced(F.plane, L.plane, dt), F.zz + dt * (L.zz * F.zz)};
}

}  // namespace mpm
