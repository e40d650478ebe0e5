#pragma once
// CPDI: the tent sampled at the corners of the particle's parallelogram (2-D) or parallelepiped (3-D), which deforms
// with F. Sadeghirad, Brannon & Burghardt, Int. J. Numer. Meth. Engng 86 (2011) 1435-1456, eqs. 17-20. With corners
// x + R s, s = (+-1, ...), R the matrix of semi-side vectors and n = 2^D corners:
//   w_i = sum_s N_i(x + R s) / n,     grad w_i = R^-T sum_s s N_i(x + R s) / n.
// The second is the mean over the domain of the gradient of the multilinear field through the corners' values.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

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
    T offset[D];  ///< place of the corner in its cell
    T side[D];    ///< R^-T s / n
  };

  /// det R and the product of the lengths of the sides.
  template <class S>
  MPM_HD static void det_and_lengths(const Mat<2, S>& R, S& det, S& lengths) {
    det = determinant(R);
    lengths = sqrt((R(0, 0) * R(0, 0) + R(1, 0) * R(1, 0)) * (R(0, 1) * R(0, 1) + R(1, 1) * R(1, 1)));
  }
  template <class S>
  MPM_HD static void det_and_lengths(const Mat<3, S>& R, S& det, S& lengths) {
    det = determinant(R);
    lengths = S(real<S>(1));
    for (int j = 0; j < 3; ++j) lengths = lengths * sqrt(R(0, j) * R(0, j) + R(1, j) * R(1, j) + R(2, j) * R(2, j));
  }
  /// R^-T.
  template <class S>
  MPM_HD static void inverse_transposed(const Mat<2, S>& R, S det, Mat<2, S>& out) {
    const S over_det = real<S>(1) / det;
    out(0, 0) = R(1, 1) * over_det, out(0, 1) = -R(1, 0) * over_det;
    out(1, 0) = -R(0, 1) * over_det, out(1, 1) = R(0, 0) * over_det;
  }
  template <class S>
  MPM_HD static void inverse_transposed(const Mat<3, S>& R, S det, Mat<3, S>& out) {
    const S over_det = real<S>(1) / det;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const int p = (i + 1) % 3, q = (i + 2) % 3, s = (j + 1) % 3, t = (j + 2) % 3;
        out(i, j) = (R(p, s) * R(q, t) - R(p, t) * R(q, s)) * over_det;
      }
  }
  /// Whether R is far enough from singular for its inverse: |det| above 64 epsilon times the product of the sides.
  template <class T>
  MPM_HD static constexpr T smallest_ratio() {
    return sizeof(T) == 4 ? T(64 * 1.1920929e-7) : T(64 * 2.220446049250313e-16);
  }

  template <int D, class T>
  MPM_HD static Corner<D, T> corner_of(int number, const Vec<D, T>& x, const Mat<D, T>& R, const Mat<D, T>& sides) {
    Corner<D, T> corner;
    for (int a = 0; a < D; ++a) {
      const T cell = floor(x[a]);  // lengths count from it, so that no digits go to the distance from the first node
      T at = x[a] - cell, side = T(0);
      for (int k = 0; k < D; ++k) {
        const T sign = number >> k & 1 ? T(1) : T(-1);
        at = at + sign * R(a, k);
        side = side + sign * sides(a, k);
      }
      const T base = floor(at);
      corner.base[a] = static_cast<int>(cell + base);
      corner.offset[a] = at - base;
      corner.side[a] = side * T(1.0 / (1 << D));
    }
    return corner;
  }

  /// The weights and gradients of nodes before they are put into the list.
  template <int D, class T>
  struct Sums {
    T weight[capacity<D>], gradient[D][capacity<D>];
  };

  template <int D, class T>
  MPM_HD static void clear(Sums<D, T>& sums, int entries) {
    for (int k = 0; k < entries; ++k) sums.weight[k] = T(0);
    for (int a = 0; a < D; ++a)
      for (int k = 0; k < entries; ++k) sums.gradient[a][k] = T(0);
  }

  /// Adds node `which` of a corner's cell to entry `k`. A flat domain takes the mean of the tents' own gradients
  /// instead.
  template <int D, class T>
  MPM_HD static void add(const Corner<D, T>& corner, int which, bool flat, Sums<D, T>& sums, int k) {
    T tent[D], w = T(1);
    for (int a = 0; a < D; ++a) {
      tent[a] = which >> a & 1 ? corner.offset[a] : T(1) - corner.offset[a];
      w = w * tent[a];
    }
    sums.weight[k] = sums.weight[k] + w * T(1.0 / (1 << D));
    if (!flat) {
      for (int a = 0; a < D; ++a) sums.gradient[a][k] = sums.gradient[a][k] + corner.side[a] * w;
      return;
    }
    for (int a = 0; a < D; ++a) {
      T g = which >> a & 1 ? T(1.0 / (1 << D)) : T(-1.0 / (1 << D));
      for (int b = 0; b < D; ++b)
        if (b != a) g = g * tent[b];
      sums.gradient[a][k] = sums.gradient[a][k] + g;
    }
  }

  /// Makes entry `k` the next of the list when anything was added to it. (No branch: which are used is at random.)
  /// There are no more entries than the list holds, so its end is never passed.
  template <int D, class T>
  MPM_HD static void keep(const Sums<D, T>& sums, int k, const int* node, List<D, T>& out) {
    T used = abs(sums.weight[k]);
    for (int a = 0; a < D; ++a) used = used + abs(sums.gradient[a][k]);
    const int to = out.count;
    out.weight[to] = sums.weight[k];
    for (int a = 0; a < D; ++a) out.node[to][a] = node[a], out.gradient[to][a] = sums.gradient[a][k];
    out.count += used != T(0) ? 1 : 0;
  }

  /// Collects corners that lie within 4 nodes an axis: each node has its place in a box of 4 nodes an axis from `low`.
  template <int D, class T>
  MPM_HD static void merge_in_box(const Corner<D, T>* corners, const int* low, const int* extent, bool flat,
                                  List<D, T>& out) {
    Sums<D, T> sums;
    clear<D, T>(sums, capacity<D>);
    for (int c = 0; c < 1 << D; ++c) {
      int first = 0;
      for (int a = 0; a < D; ++a) first += (corners[c].base[a] - low[a]) << 2 * a;
      for (int which = 0; which < 1 << D; ++which)
        add<D, T>(corners[c], which, flat, sums, first + (which & 1) + (which >> 1 & 1) * 4 + (which >> 2) * 16);
    }
    out.count = 0;
    for (int z = 0; z < (D == 3 ? extent[D - 1] : 1); ++z)
      for (int y = 0; y < extent[1]; ++y)
        for (int x = 0; x < extent[0]; ++x) {
          const int node[3] = {low[0] + x, low[1] + y, low[D - 1] + z};
          keep<D, T>(sums, (z * 4 + y) * 4 + x, node, out);
        }
  }

  /// Collects corners far apart: every node is looked up among those already there.
  template <int D, class T>
  MPM_HD static void merge_by_search(const Corner<D, T>* corners, bool flat, List<D, T>& out) {
    Sums<D, T> sums;
    clear<D, T>(sums, capacity<D>);
    int entries = 0, node[capacity<D>][D];
    for (int c = 0; c < 1 << D; ++c)
      for (int which = 0; which < 1 << D; ++which) {
        int k = 0;
        for (; k < entries; ++k) {
          bool same = true;
          for (int a = 0; a < D; ++a) same = same && node[k][a] == corners[c].base[a] + (which >> a & 1);
          if (same) break;
        }
        if (k == entries) {
          for (int a = 0; a < D; ++a) node[k][a] = corners[c].base[a] + (which >> a & 1);
          ++entries;
        }
        add<D, T>(corners[c], which, flat, sums, k);
      }
    out.count = 0;
    for (int k = 0; k < entries; ++k) keep<D, T>(sums, k, node[k], out);
  }

  /// x and domain in cells; column k of `domain` is the k-th semi-side vector. Each node comes once.
  template <int D, class T>
  MPM_HD static void evaluate(const Parameters&, const Vec<D, T>& x, const Mat<D, T>& domain, List<D, T>& out) {
    Mat<D, T> sides;
    T det, lengths;
    det_and_lengths(domain, det, lengths);
    const bool flat = !(abs(det) > smallest_ratio<T>() * lengths);
    inverse_transposed(domain, det, sides);
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

  // ---- boxes of W nodes an axis, over lanes ------------------------------------------------------------------------

  /// The first node of the box that holds the particle's nodes, and how many there are along its longest axis. The
  /// first node is that of the quadratic B-spline unless the domain reaches below it: neighbours in a cell then share
  /// it. The result is 0 for more than 4 nodes, for what is not a number, and, with gradients, for a domain that has
  /// collapsed.
  template <int D, class S>
  MPM_HD static S box(const Parameters&, const Vec<D, S>& x, const Mat<D, S>& domain, bool gradients, Vec<D, S>& base) {
    S extent(real<S>(2)), fits(real<S>(1));
    for (int a = 0; a < D; ++a) {
      const S cell = floor(x[a]), at = x[a] - cell;
      S low = at, high = at;
      for (int k = 0; k < D; ++k) low = low - abs(domain(a, k)), high = high + abs(domain(a, k));
      const S first = min(floor(low), floor(at - real<S>(0.5))), span = floor(high) - first + real<S>(2);
      base[a] = cell + first;
      extent = max(extent, span);
      fits = select(span <= real<S>(4), fits, S(real<S>(0)));
    }
    if (gradients) {
      S det, lengths;
      det_and_lengths(domain, det, lengths);
      fits = select(abs(det) > smallest_ratio<scalar_of<S>>() * lengths, fits, S(real<S>(0)));
    }
    for (int a = 0; a < D; ++a) base[a] = select(fits > real<S>(0), base[a], S(real<S>(0)));
    return select(fits > real<S>(0), extent, S(real<S>(0)));
  }

  /// Tents of a corner along one axis that lies 1 - d from the box's first node; none of them is below zero when the
  /// box holds the corner. The tents that boxes of both widths have are the same for either W.
  template <int W, class S>
  MPM_HD static void tents(S d, S* w) {
    const S none(real<S>(0));
    w[0] = max(d, none);
    const S beyond = w[0] - d;  // max(-d, 0)
    if constexpr (W == 3) {
      w[1] = real<S>(1) - (w[0] + beyond);
      w[2] = beyond;
    } else {
      w[1] = max(real<S>(1) - (w[0] + beyond), none);
      w[2] = min(beyond, d + real<S>(2));
      w[3] = max(real<S>(-1) - d, none);
    }
  }

  /// What the rows of a box are made from: the corners' tents along each axis, and R^-T s / n.
  template <int W, int D, class S>
  struct Rows {
    S tent[D][1 << D][W], side[D][1 << D];
  };

  /// The places from + R s along axis a for all corners, added up as in corner_of.
  template <int D, class S>
  MPM_HD static void corners_from(S from, const Mat<D, S>& R, int a, S* corner) {
    corner[0] = from;
    MPM_UNROLL
    for (int k = 0; k < D; ++k) MPM_UNROLL
    for (int c = 0; c < 1 << k; ++c) {
      corner[c + (1 << k)] = corner[c] + R(a, k);
      corner[c] = corner[c] - R(a, k);
    }
  }

  /// Prepares the rows of a box. `base` is as `box` gave it; the sides are made only with gradients.
  template <int W, int D, class S>
  MPM_HD static void prepare_rows(const Parameters&, const Vec<D, S>& x, const Mat<D, S>& domain, const Vec<D, S>& base,
                                  bool gradients, Rows<W, D, S>& rows) {
    S corner[1 << D];
    for (int a = 0; a < D; ++a) {
      const S cell = floor(x[a]), second = base[a] - cell + real<S>(1);
      corners_from<D, S>(x[a] - cell, domain, a, corner);
      MPM_UNROLL
      for (int c = 0; c < 1 << D; ++c) tents<W, S>(second - corner[c], rows.tent[a][c]);
    }
    if (!gradients) return;
    Mat<D, S> sides;
    inverse_transposed(domain, determinant(domain) * real<S>(1 << D), sides);
    for (int a = 0; a < D; ++a) corners_from<D, S>(S(real<S>(0)), sides, a, rows.side[a]);
  }

  /// Weights, and gradients [D][W], of the nodes (i, j, k), k < W, of the box; in 2-D of the nodes (i, k).
  template <int W, int D, bool Gradients, class S>
  MPM_HD static void row_in_box(const Rows<W, D, S>& rows, int i, int j, S* w, S (*g)[W]) {
    S sum[W], slope[D][W];
    MPM_UNROLL
    for (int c = 0; c < 1 << D; ++c) {
      S xy = rows.tent[0][c][i];
      if constexpr (D == 3) xy = xy * rows.tent[1][c][j];
      MPM_UNROLL
      for (int k = 0; k < W; ++k) {
        const S term = xy * rows.tent[D - 1][c][k];
        sum[k] = c == 0 ? term : sum[k] + term;
      }
      if constexpr (Gradients) MPM_UNROLL
      for (int a = 0; a < D; ++a) {
        const S vector = xy * rows.side[a][c];
        MPM_UNROLL
        for (int k = 0; k < W; ++k) {
          const S term = vector * rows.tent[D - 1][c][k];
          slope[a][k] = c == 0 ? term : slope[a][k] + term;
        }
      }
    }
    MPM_UNROLL
    for (int k = 0; k < W; ++k) w[k] = sum[k] * real<S>(1.0 / (1 << D));
    if constexpr (Gradients) MPM_UNROLL
    for (int a = 0; a < D; ++a) MPM_UNROLL
    for (int k = 0; k < W; ++k) g[a][k] = slope[a][k];
  }

  /// The second moment sum w d d^T: R R^T from the corners, and from each tent the product of its two weights.
  template <int W, int D, class S>
  MPM_HD static Mat<D, S> moment_of_box(const Rows<W, D, S>& rows, const Mat<D, S>& domain) {
    Mat<D, S> moment;
    for (int a = 0; a < D; ++a)
      for (int b = 0; b <= a; ++b) {
        S sum = domain(a, 0) * domain(b, 0);
        for (int k = 1; k < D; ++k) sum = sum + domain(a, k) * domain(b, k);
        moment(a, b) = moment(b, a) = sum;
      }
    for (int a = 0; a < D; ++a) {
      S sum(real<S>(0));
      MPM_UNROLL
      for (int c = 0; c < 1 << D; ++c) {
        MPM_UNROLL
        for (int k = 1; k < W; ++k) sum = sum + rows.tent[a][c][k - 1] * rows.tent[a][c][k];
      }
      moment(a, a) = moment(a, a) + sum * real<S>(1.0 / (1 << D));
    }
    return moment;
  }

#if MPM_HOST
  static constexpr unsigned needs = MPM_NEEDS_DOMAIN;
  /// Measured: docs/studies/extremes.md, "How long a step".
  static constexpr double courant_limits[2][3] = {{0.83, 0.57, 0.8}, {0.56, 0.31, 1}};
#endif
};

}  // namespace mpm
