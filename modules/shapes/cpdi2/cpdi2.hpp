#pragma once
// CPDI2: the tent sampled at the corners of the particle's quadrilateral (2-D) or hexahedron (3-D), which the grid's
// velocity moves, so that neighbours keep the corners they share. Sadeghirad, Brannon & Guilkey, Int. J. Numer. Meth.
// Engng 95 (2013) 928-952. With the multilinear functions Q_c of the corners x_c, and means over the domain:
//   w_i = sum_c <Q_c> N_i(x_c),     grad w_i = sum_c <grad Q_c> N_i(x_c).

#include "kernel/corner_domain.hpp"
#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct Cpdi2 {
  template <int D>
  static constexpr int capacity = D == 2 ? 16 : 64;  ///< 2^D corners, each in a cell of 2^D nodes
  template <int D>
  static constexpr int sample_points = 1 << D;
  static constexpr double reach = 1;  ///< cells beyond the corners

  struct Parameters {};

  /// Lists the nodes. x is in cells, corners count from x. Each node comes once; there is none where the domain is
  /// turned inside out.
  template <int D, class T>
  MPM_HD static void evaluate(const Parameters&, const Vec<D, T>& x, const Vec<D, T>* corners,
                              NodeList<D, T, capacity<D>>& out) {
    out.count = 0;
    const CornerDomain<D, T> domain = corner_domain<D, T>(corners);
    if (!domain.upright) return;
    for (int c = 0; c < 1 << D; ++c) {
      const TentCell<D, T> cell(x, corners[c]);
      for (int which = 0; which < 1 << D; ++which) {
        const T tent = cell.weight(which);
        if (tent == T(0)) continue;
        const int k = entry_of<D, T>(cell, which, out);
        out.weight[k] = out.weight[k] + domain.weight[c] * tent;
        for (int a = 0; a < D; ++a) out.gradient[k][a] = out.gradient[k][a] + domain.gradient[c][a] * tent;
      }
    }
  }

  /// The place of a cell's node in the list; new nodes go to its end.
  template <int D, class T>
  MPM_HD static int entry_of(const TentCell<D, T>& cell, int which, NodeList<D, T, capacity<D>>& out) {
    for (int k = 0; k < out.count; ++k) {
      bool same = true;
      for (int a = 0; a < D; ++a) same = same && out.node[k][a] == cell.node(which, a);
      if (same) return k;
    }
    const int k = out.count++;
    out.weight[k] = T(0);
    for (int a = 0; a < D; ++a) out.node[k][a] = cell.node(which, a), out.gradient[k][a] = T(0);
    return k;
  }

#if MPM_HOST
  static constexpr mpm_second_moment second_moment_kind = MPM_MOMENT_PER_PARTICLE;
  /// Measured: docs/studies/extremes.md, "How long a step".
  static constexpr double courant_limits[2][3] = {{0.76, 0.57, 0.8}, {0.56, 0.31, 1}};
#endif
};

}  // namespace mpm
