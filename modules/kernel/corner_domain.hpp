#pragma once
// A quadrilateral (2-D) or hexahedron (3-D) as the image of the square or cube under the multilinear map through its
// corners; corner c is at the upper end along axis k where bit k of c is set. Integrals are taken with 2^D Gauss
// points, which is exact: Q_c det J and the cofactors of J times grad Q_c are at most cubic along each axis.

#include "kernel/tensor.hpp"

namespace mpm {

/// Means over the domain of the corners' multilinear functions Q_c and of their gradients in space.
template <int D, class T>
struct CornerDomain {
  static constexpr int corners = 1 << D;
  bool upright;  ///< the map keeps its orientation at every corner; false where a corner is not a number
  T volume;
  T weight[corners];            ///< mean of Q_c: their sum is 1, and sum_c weight x_c is the centroid
  Vec<D, T> gradient[corners];  ///< mean of grad Q_c, per length
};

/// J of the map at a point of [-1, 1]^D, and the derivatives of Q_c there with respect to that point.
template <int D, class T>
MPM_HD Mat<D, T> corner_map(const Vec<D, T>* corner, const T* at, T (&value)[1 << D], Vec<D, T> (&slope)[1 << D]) {
  Mat<D, T> J{};
  for (int c = 0; c < 1 << D; ++c) {
    T half[D];
    value[c] = T(1);
    for (int a = 0; a < D; ++a) {
      half[a] = T(0.5) * (c >> a & 1 ? T(1) + at[a] : T(1) - at[a]);
      value[c] = value[c] * half[a];
    }
    for (int a = 0; a < D; ++a) {
      slope[c][a] = c >> a & 1 ? T(0.5) : T(-0.5);
      for (int b = 0; b < D; ++b)
        if (b != a) slope[c][a] = slope[c][a] * half[b];
      for (int i = 0; i < D; ++i) J(i, a) = J(i, a) + corner[c][i] * slope[c][a];
    }
  }
  return J;
}

/// The derivative d det J / d J.
template <class T>
MPM_HD Mat<2, T> cofactors(const Mat<2, T>& J) {
  return {{J(1, 1), -J(1, 0), -J(0, 1), J(0, 0)}};
}
template <class T>
MPM_HD Mat<3, T> cofactors(const Mat<3, T>& J) {
  Mat<3, T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int p = (i + 1) % 3, q = (i + 2) % 3, s = (j + 1) % 3, t = (j + 2) % 3;
      r(i, j) = J(p, s) * J(q, t) - J(p, t) * J(q, s);
    }
  return r;
}

template <int D, class T>
MPM_HD CornerDomain<D, T> corner_domain(const Vec<D, T>* corner) {
  constexpr int n = 1 << D;
  CornerDomain<D, T> domain{};
  T value[n], at[D];
  Vec<D, T> slope[n];
  domain.upright = true;
  for (int point = 0; point < n; ++point) {
    for (int a = 0; a < D; ++a) at[a] = point >> a & 1 ? T(1) : T(-1);
    domain.upright = domain.upright && determinant(corner_map<D, T>(corner, at, value, slope)) > T(0);
    for (int a = 0; a < D; ++a) at[a] = at[a] * T(0.57735026918962576451);
    const Mat<D, T> J = corner_map<D, T>(corner, at, value, slope), cofactor = cofactors(J);
    const T det = determinant(J);
    domain.volume = domain.volume + det;
    for (int c = 0; c < n; ++c) {
      domain.weight[c] = domain.weight[c] + value[c] * det;
      for (int i = 0; i < D; ++i)
        for (int a = 0; a < D; ++a) domain.gradient[c][i] = domain.gradient[c][i] + cofactor(i, a) * slope[c][a];
    }
  }
  const T over_volume = T(1) / domain.volume;
  for (int c = 0; c < n; ++c) {
    domain.weight[c] = domain.weight[c] * over_volume;
    for (int i = 0; i < D; ++i) domain.gradient[c][i] = domain.gradient[c][i] * over_volume;
  }
  return domain;
}

/// Centroid of the domain.
template <int D, class T>
MPM_HD Vec<D, T> centroid(const CornerDomain<D, T>& domain, const Vec<D, T>* corner) {
  Vec<D, T> centre{};
  for (int c = 0; c < 1 << D; ++c)
    for (int i = 0; i < D; ++i) centre[i] = centre[i] + domain.weight[c] * corner[c][i];
  return centre;
}

/// The cell of a point and the tents of its 2^D nodes: node `which` is at the upper end along axis a where bit a is
/// set. `x` and `from` are in cells; the point is x + from, with the digits of `from` kept far from the grid's first
/// node.
template <int D, class T>
struct TentCell {
  int base[D];
  T offset[D];
  MPM_HD TentCell(const Vec<D, T>& x, const Vec<D, T>& from) {
    for (int a = 0; a < D; ++a) {
      const T cell = floor(x[a]), at = x[a] - cell + from[a], lower = floor(at);
      base[a] = static_cast<int>(cell + lower);
      offset[a] = at - lower;
    }
  }
  MPM_HD int node(int which, int axis) const { return base[axis] + (which >> axis & 1); }
  MPM_HD T weight(int which) const {
    T w = T(1);
    for (int a = 0; a < D; ++a) w = w * (which >> a & 1 ? offset[a] : T(1) - offset[a]);
    return w;
  }
};

}  // namespace mpm
