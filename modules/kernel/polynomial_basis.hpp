#pragma once
// Polynomials that a particle carries beyond the affine ones: products of one polynomial an axis, orthogonal under the
// weights of that axis, of powers up to `order`, whose powers sum to 2 or more. Fu et al., ACM Trans. Graph. 36 (2017)
// 222. Lengths are in cells.

#include "kernel/config.hpp"

namespace mpm {

/// Number of products.
MPM_HD constexpr int basis_functions(int dimension, int order) {
  const int powers = order + 1;
  if (order < 1) return 0;
  return dimension == 2 ? powers * powers - 3 : powers * powers * powers - 4;
}

/// Calls visit(number, powers along the axes) for each product.
template <int D, class Visit>
MPM_HD void for_each_product(int order, Visit visit) {
  int number = 0;
  for (int x = 0; x <= order; ++x)
    for (int y = 0; y <= order; ++y)
      for (int z = 0; z <= (D == 3 ? order : 0); ++z) {
        if (x + y + z < 2) continue;
        const int powers[3] = {x, y, z};
        visit(number++, powers);
      }
}

/// The polynomials P_r of one axis with K nodes: P_0 = 1, P_1 = d, P_2 = d^2 - (sum w d^3 / D) d - D ...
template <int K, class T>
struct AxisBasis {
  T given[K][K];  ///< [r][node] w P_r: what a node gets of coefficient r
  T taken[K][K];  ///< [r][node] that gives coefficient r back: w P_r / sum w P_r^2
  T norm[K];      ///< sum w P_r^2
};

/// Makes the polynomials of powers up to `order`, which is below K. Node k has the weight w[k * stride] and lies k -
/// offset from the particle.
template <int K, class T>
MPM_HD void make_axis_basis(const T* w, int stride, T offset, int order, AxisBasis<K, T>& out) {
  T before[K], now[K];  // P_(r-1), P_r
  T slope = T(0), ratio = T(0);
  for (int k = 0; k < K; ++k) before[k] = T(0), now[k] = T(1);
  for (int r = 0; r <= order; ++r) {
    T norm = T(0), third = T(0);
    for (int k = 0; k < K; ++k) {
      const T d = T(k) - offset;
      if (r > 0) {  // three-term recurrence
        const T next = (d - slope) * now[k] - ratio * before[k];
        before[k] = now[k], now[k] = next;
      }
      const T weighted = w[k * stride] * now[k];
      out.given[r][k] = weighted;
      norm += weighted * now[k], third += weighted * now[k] * d;
    }
    out.norm[r] = norm;
    slope = r == 0 ? T(0) : third / norm;  // sum w d = 0
    ratio = r == 0 ? norm : norm / out.norm[r - 1];
    if (r < K - 1)
      for (int k = 0; k < K; ++k) out.taken[r][k] = out.given[r][k] / norm;
  }
  if (order < K - 1) return;
  // The coefficient of the highest power is taken by the finite difference, the one functional in which no lower power
  // shows. No weight divides it.
  T choose = T(1);
  for (int k = 0; k < K; ++k) {
    out.taken[K - 1][k] = ((K - 1 - k) % 2 ? -choose : choose) / T(K < 4 ? K - 1 : 6);
    choose = choose * T(K - 1 - k) / T(k + 1);
  }
}

}  // namespace mpm
