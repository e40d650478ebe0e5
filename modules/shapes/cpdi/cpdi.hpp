#pragma once
// CPDI: the tent sampled at the corners of the particle's parallelogram (2-D) or parallelepiped (3-D), which deforms
// with F. Sadeghirad, Brannon & Burghardt, Int. J. Numer. Meth. Engng 86 (2011) 1435-1456, eqs. 17-20. With corners
// x + R s, s = (+-1, ...), R the matrix of semi-side vectors and n = 2^D corners:
//   w_i = sum_s N_i(x + R s) / n,     grad w_i = R^-T sum_s s N_i(x + R s) / n.
// The second is the mean over the domain of the gradient of the multilinear field through the corners' values.

#include "kernel/functor.hpp"

namespace mpm {

struct Cpdi {
  template <int D>
  static constexpr int capacity = D == 2 ? 16 : 64;  ///< 2^D corners, each in a cell of 2^D nodes
  static constexpr double reach = 1;                 ///< cells beyond the corners

  struct Parameters {};

  template <int D, class T>
  using List = NodeList<D, T, capacity<D>>;

  /// What a corner gives to the 2^D nodes of its cell: the tents' weights and the vector that multiplies them.
  template <int D, class T>
  struct Corner {
    int base[D];
    T offset[D];  ///< of the corner in its cell
    T side[D];    ///< R^-T s / n
  };

  /// R^-T, and whether R is far enough from singular for it: |det| above 64 epsilon times the product of the sides.
  template <class T>
  MPM_HD static bool inverse_transposed(const Mat<2, T>& R, Mat<2, T>& out) {
    const T det = determinant(R);
    const T lengths = sqrt((R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0)) * (R(0, 1) * R(0, 1) + R(1, 1) * R(1, 1)));
    out(0, 0) = R(1, 1) / det, out(0, 1) = -R(1, 0) / det;
    out(1, 0) = -R(0, 1) / det, out(1, 1) = R(0, 0) / det;
    return abs(det) > smallest_ratio<T>() * lengths;
  }
  template <class T>
  MPM_HD static bool inverse_transposed(const Mat<3, T>& R, Mat<3, T>& out) {
    const T det = determinant(R);
    T lengths = 1;
    for (int j = 0; j < 3; ++j) {
      lengths = lengths * sqrt(R(0, j) * R(0, j) + R(1, j) * R(1, j) + R(2, j) * R(2, j));
      for (int i = 0; i < 3; ++i) {
        const int p = (i + 1) % 3, q = (i + 2) % 3, s = (j + 1) % 3, t = (j + 2) % 3;
        out(i, j) = (R(p, s) * R(q, t) - R(p, t) * R(q, s)) / det;
      }
    }
    return abs(det) > smallest_ratio<T>() * lengths;
  }
  template <class T>
  MPM_HD static constexpr T smallest_ratio() {
    return sizeof(T) == 4 ? T(64 * 1.1920929e-7) : T(64 * 2.220446049250313e-16);
  }

  template <int D, class T>
  MPM_HD static Corner<D, T> corner_of(int number, const Vec<D, T>& x, const Mat<D, T>& R, const Mat<D, T>& sides) {
    Corner<D, T> corner;
    for (int a = 0; a < D; ++a) {
      T at = x[a], side = T(0);
      for (int k = 0; k < D; ++k) {
        const T sign = number >> k & 1 ? T(1) : T(-1);
        at = at + sign * R(a, k);
        side = side + sign * sides(a, k);
      }
      const T base = floor(at);
      corner.base[a] = static_cast<int>(base);
      corner.offset[a] = at - base;
      corner.side[a] = side * T(1.0 / (1 << D));
    }
    return corner;
  }

  /// Adds one node of a corner's cell to entry `k`. A flat domain takes the mean of the tents' own gradients instead.
  template <int D, class T>
  MPM_HD static void add(const Corner<D, T>& corner, int which, bool flat, List<D, T>& out, int k) {
    T tent[D], w = T(1.0 / (1 << D));
    for (int a = 0; a < D; ++a) {
      tent[a] = which >> a & 1 ? corner.offset[a] : T(1) - corner.offset[a];
      w = w * tent[a];
    }
    out.weight[k] = out.weight[k] + w;
    for (int a = 0; a < D; ++a) {
      T g = corner.side[a] * (w * T(1 << D));
      if (flat) {
        g = which >> a & 1 ? T(1.0 / (1 << D)) : T(-1.0 / (1 << D));
        for (int b = 0; b < D; ++b)
          if (b != a) g = g * tent[b];
      }
      out.gradient[k][a] = out.gradient[k][a] + g;
    }
  }

  template <int D, class T>
  MPM_HD static void clear(List<D, T>& out, int k) {
    out.weight[k] = T(0);
    for (int a = 0; a < D; ++a) out.gradient[k][a] = T(0);
  }

  /// Drops the entries that nothing was added to; the others keep their order.
  template <int D, class T>
  MPM_HD static void compact(List<D, T>& out, int entries) {
    out.count = 0;
    for (int k = 0; k < entries; ++k) {
      bool used = out.weight[k] != T(0);
      for (int a = 0; a < D; ++a) used = used || out.gradient[k][a] != T(0);
      if (!used) continue;
      const int to = out.count++;
      out.weight[to] = out.weight[k];
      for (int a = 0; a < D; ++a) out.node[to][a] = out.node[k][a], out.gradient[to][a] = out.gradient[k][a];
    }
  }

  /// Corners that lie within 4 nodes an axis: each node has its place in a box of `extent` nodes from `low`.
  template <int D, class T>
  MPM_HD static void merge_in_box(const Corner<D, T>* corners, const int* low, const int* extent, bool flat,
                                  List<D, T>& out) {
    int entries = 1;
    for (int a = 0; a < D; ++a) entries = entries * extent[a];
    for (int k = 0; k < entries; ++k) {
      clear<D, T>(out, k);
      int rest = k;
      for (int a = 0; a < D; ++a) out.node[k][a] = low[a] + rest % extent[a], rest = rest / extent[a];
    }
    for (int c = 0; c < 1 << D; ++c)
      for (int which = 0; which < 1 << D; ++which) {
        int k = 0;
        for (int a = D - 1; a >= 0; --a) k = k * extent[a] + corners[c].base[a] - low[a] + (which >> a & 1);
        add<D, T>(corners[c], which, flat, out, k);
      }
    compact<D, T>(out, entries);
  }

  /// Corners far apart: every node is looked up among those already there.
  template <int D, class T>
  MPM_HD static void merge_by_search(const Corner<D, T>* corners, bool flat, List<D, T>& out) {
    int entries = 0;
    for (int c = 0; c < 1 << D; ++c)
      for (int which = 0; which < 1 << D; ++which) {
        int k = 0;
        for (; k < entries; ++k) {
          bool same = true;
          for (int a = 0; a < D; ++a) same = same && out.node[k][a] == corners[c].base[a] + (which >> a & 1);
          if (same) break;
        }
        if (k == entries) {
          clear<D, T>(out, entries++);
          for (int a = 0; a < D; ++a) out.node[k][a] = corners[c].base[a] + (which >> a & 1);
        }
        add<D, T>(corners[c], which, flat, out, k);
      }
    compact<D, T>(out, entries);
  }

  /// x and domain in cells; column k of `domain` is the k-th semi-side vector. Each node comes once.
  template <int D, class T>
  MPM_HD static void evaluate(const Parameters&, const Vec<D, T>& x, const Mat<D, T>& domain, List<D, T>& out) {
    Mat<D, T> sides;
    const bool flat = !inverse_transposed(domain, sides);
    Corner<D, T> corners[1 << D];
    int low[D], extent[D];
    bool close = true;
    for (int c = 0; c < 1 << D; ++c) corners[c] = corner_of<D, T>(c, x, domain, flat ? Mat<D, T>{} : sides);
    for (int a = 0; a < D; ++a) {
      int high = low[a] = corners[0].base[a];
      for (int c = 1; c < 1 << D; ++c) {
        low[a] = corners[c].base[a] < low[a] ? corners[c].base[a] : low[a];
        high = corners[c].base[a] > high ? corners[c].base[a] : high;
      }
      extent[a] = high - low[a] + 2;
      close = close && extent[a] <= 4;
    }
    if (close)
      merge_in_box<D, T>(corners, low, extent, flat, out);
    else
      merge_by_search<D, T>(corners, flat, out);
  }

#if MPM_HOST
  static constexpr unsigned needs = MPM_NEEDS_DOMAIN;
#endif
};

}  // namespace mpm
