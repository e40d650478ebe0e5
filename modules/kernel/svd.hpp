#pragma once
// Singular value and polar decompositions of 2 x 2 and 3 x 3 matrices without branches, for float, double, lanes and
// the device pass alike. One-sided Jacobi (Hestenes 1958; Demmel & Veselic, SIAM J. Matrix Anal. Appl. 13 (1992) 1204)
// turns the columns orthogonal; a triangularisation by Givens rotations then gives U, which stays a rotation when
// columns vanish (McAdams et al., Univ. of Wisconsin TR1690 (2011)).

#include "kernel/tensor.hpp"

namespace mpm {

/// A = U diag(values) V^T. U and V are rotations (det +1); |values| descend and only the last may be negative.
template <int D, class S>
struct SingularValues {
  Mat<D, S> U, V;
  Vec<D, S> values;
};

namespace svd {

/// The bound below which a number or its square has lost digits; after scaling by the largest entry such numbers are
/// taken for zero.
template <class S>
MPM_HD constexpr scalar_of<S> tiny() {
  return sizeof(scalar_of<S>) == 4 ? scalar_of<S>(1.2e-38) : scalar_of<S>(2.3e-308);
}

/// A squared length whose own square still is an ordinary number.
template <class S>
MPM_HD constexpr scalar_of<S> smallest_square() {
  return sizeof(scalar_of<S>) == 4 ? scalar_of<S>(1e-18) : scalar_of<S>(1e-153);
}

/// Sweeps of Jacobi that reach rounding from any start, found by trial with one to spare.
template <int D, class S>
MPM_HD constexpr int sweeps() {
  return D == 2 ? 3 : (sizeof(scalar_of<S>) == 4 ? 5 : 6);
}

/// Columns p and q of M: (p, q) <- (c p - s q, s p + c q).
template <int D, class S>
MPM_HD void rotate_columns(Mat<D, S>& M, int p, int q, S c, S s) {
  for (int i = 0; i < D; ++i) {
    const S a = M(i, p), b = M(i, q);
    M(i, p) = c * a - s * b;
    M(i, q) = s * a + c * b;
  }
}

/// Turns columns p and q of B, and of V with them, so that they become orthogonal. The angle is at most 45 degrees.
template <int D, class S>
MPM_HD void orthogonalise(Mat<D, S>& B, Mat<D, S>& V, int p, int q) {
  S alpha = B(0, p) * B(0, p), beta = B(0, q) * B(0, q), gamma = B(0, p) * B(0, q);
  for (int i = 1; i < D; ++i) {
    alpha = alpha + B(i, p) * B(i, p);
    beta = beta + B(i, q) * B(i, q);
    gamma = gamma + B(i, p) * B(i, q);
  }
  // Tangent of the angle: sine / cosine = 2 gamma sign(beta - alpha) / (|beta - alpha| + hypotenuse). Columns whose
  // squares leave the range of S are far below rounding of the largest and stay as they are.
  const S twice = gamma + gamma, difference = beta - alpha;
  const S cosine = abs(difference) + sqrt(difference * difference + twice * twice);
  const S sine = select(difference < real<S>(0), -twice, twice);
  const S inverse = real<S>(1) / sqrt(max(cosine * cosine + sine * sine, S(tiny<S>())));
  const auto turns = cosine > smallest_square<S>();
  const S c = select(turns, cosine * inverse, S(real<S>(1))), s = select(turns, sine * inverse, S(real<S>(0)));
  rotate_columns(B, p, q, c, s);
  rotate_columns(V, p, q, c, s);
}

/// Columns (p, q) <- (q, -p) where the mask holds.
template <int D, class S, class Mask>
MPM_HD void swap_columns(Mat<D, S>& M, int p, int q, const Mask& swap) {
  for (int i = 0; i < D; ++i) {
    const S a = M(i, p), b = M(i, q);
    M(i, p) = select(swap, b, a);
    M(i, q) = select(swap, -a, b);
  }
}

/// Puts the longer of columns p and q first; the sign of one changes, so that V stays a rotation.
template <int D, class S>
MPM_HD void sort_columns(Mat<D, S>& B, Mat<D, S>& V, int p, int q) {
  S alpha = B(0, p) * B(0, p), beta = B(0, q) * B(0, q);
  for (int i = 1; i < D; ++i) alpha = alpha + B(i, p) * B(i, p), beta = beta + B(i, q) * B(i, q);
  const auto swap = alpha < beta;
  swap_columns(B, p, q, swap);
  swap_columns(V, p, q, swap);
}

/// Turns rows p and q of B so that B(q, p) vanishes and B(p, p) >= 0; U takes the inverse.
template <int D, class S>
MPM_HD void eliminate(Mat<D, S>& B, Mat<D, S>& U, int p, int q) {
  const S a = B(p, p), b = B(q, p), largest = max(abs(a), abs(b)), divisor = max(largest, S(tiny<S>()));
  const auto vanishes = largest < tiny<S>();
  const S x = select(vanishes, S(real<S>(1)), a / divisor), y = select(vanishes, S(real<S>(0)), b / divisor);
  const S length = sqrt(x * x + y * y), c = x / length, s = y / length;
  for (int j = 0; j < D; ++j) {
    const S u = B(p, j), v = B(q, j);
    B(p, j) = c * u + s * v;
    B(q, j) = c * v - s * u;
  }
  rotate_columns(U, p, q, c, -s);
}

/// Turns all columns of B orthogonal by the rotation V.
template <int D, class S>
MPM_HD void orthogonalise_all(Mat<D, S>& B, Mat<D, S>& V) {
  V = Mat<D, S>::identity();
  for (int sweep = 0; sweep < sweeps<D, S>(); ++sweep)
    for (int p = 0; p < D - 1; ++p)
      for (int q = p + 1; q < D; ++q) orthogonalise(B, V, p, q);
}

/// The largest entry, by which a matrix is divided so that squares stay in range.
template <int D, class S>
MPM_HD S largest_entry(const Mat<D, S>& A) {
  S scale = abs(A.m[0]);
  for (int k = 1; k < D * D; ++k) scale = max(scale, abs(A.m[k]));
  return max(scale, S(tiny<S>()));
}

}  // namespace svd

template <int D, class S>
MPM_HD SingularValues<D, S> singular_value_decomposition(const Mat<D, S>& A) {
  const S scale = svd::largest_entry(A);
  Mat<D, S> B;
  for (int k = 0; k < D * D; ++k) B.m[k] = A.m[k] / scale;
  SingularValues<D, S> r;
  r.U = Mat<D, S>::identity();
  svd::orthogonalise_all(B, r.V);
  for (int last = D - 1; last > 0; --last)
    for (int p = 0; p < last; ++p) svd::sort_columns(B, r.V, p, p + 1);
  for (int p = 0; p < D - 1; ++p)
    for (int q = p + 1; q < D; ++q) svd::eliminate(B, r.U, p, q);
  for (int i = 0; i < D; ++i) r.values[i] = scale * B(i, i);
  return r;
}

/// A A^T = U diag(stretch^2) U^T: the principal directions and stretches of F, without V; in no order, not negative.
template <int D, class S>
struct LeftStretches {
  Mat<D, S> U;  ///< a rotation
  Vec<D, S> stretch;
};

/// The left stretches of A, for half the work of the whole decomposition.
template <int D, class S>
MPM_HD LeftStretches<D, S> left_stretches(const Mat<D, S>& A) {
  const S scale = svd::largest_entry(A);
  Mat<D, S> B;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) B(i, j) = A(j, i) / scale;
  LeftStretches<D, S> r;
  svd::orthogonalise_all(B, r.U);
  for (int j = 0; j < D; ++j) {
    S squared = B(0, j) * B(0, j);
    for (int i = 1; i < D; ++i) squared = squared + B(i, j) * B(i, j);
    r.stretch[j] = scale * sqrt(squared);
  }
  return r;
}

/// The product U diag(values) V^T.
template <int D, class S>
MPM_HD Mat<D, S> composed(const Mat<D, S>& U, const Vec<D, S>& values, const Mat<D, S>& V) {
  Mat<D, S> r;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      S t = U(i, 0) * values[0] * V(j, 0);
      for (int k = 1; k < D; ++k) t = t + U(i, k) * values[k] * V(j, k);
      r(i, j) = t;
    }
  return r;
}

/// The rotation R = U V^T nearest to A: A = R P with P symmetric, and positive where det A > 0.
template <int D, class S>
MPM_HD Mat<D, S> polar_rotation(const Mat<D, S>& A) {
  const SingularValues<D, S> parts = singular_value_decomposition(A);
  Mat<D, S> r;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      S t = parts.U(i, 0) * parts.V(j, 0);
      for (int k = 1; k < D; ++k) t = t + parts.U(i, k) * parts.V(j, k);
      r(i, j) = t;
    }
  return r;
}

}  // namespace mpm
