#pragma once
// Scatter and gather between one chunk of particles and the tile of nodes around its block, specialised at compile
// time.
//
// A tile is the block with one cell of drift on each side and the reach of the stencil: (side + K + 1)^D nodes of one
// quad. Coefficients of a particle are quads: [b' | Q_a, a < D (affine) | S_a, a < D (gradient)], and a node (i, j, k)
// of its stencil gets
//   w_i w_j w_k (b' + i Q_x + j Q_y + k Q_z) + grad terms,    b' = b - h A f,  Q_a = h A e_a,  S_a = S e_a / h.
// The gather returns in the same places  sum w v,  sum k_a w v  and  sum (dw/dx_a) v.

#include <cstdint>
#include <cstring>

#include "blocks.hpp"
#include "quad.hpp"

namespace mpm::cpu {

/// Weights of one chunk. Arrays [axis * K + k][chunk_size].
template <class T>
struct Stencils {
  const std::int32_t* tile_node;  ///< first node of the stencil in the tile
  const T* weight;
  const T* gradient;  ///< per cell
};

/// What part of a tile its particles reach: first nodes of stencils, from the tile's corner.
struct Reach {
  int lowest[3] = {1 << 20, 1 << 20, 1 << 20}, highest[3] = {-1, -1, -1};
};

template <int D, class T>
struct TileKernels {
  using Scatter = void (*)(T* tile, const Stencils<T>&, const T* coefficients, int count);
  using Gather = void (*)(const T* tile, const Stencils<T>&, T* moments, int count);
  int side = 0, nodes = 0;
  Scatter scatter[2][2];  ///< [affine][gradient]
  Gather gather[2][2];    ///< [moment][gradient]
  void (*load)(T* tile, const T* channel, const std::int32_t* neighbours, const Reach&);
  void (*flush)(T* tile, T* channel, const std::int32_t* neighbours, const Reach&);  ///< adds, and clears the tile
};

/// Kernels for a stencil of `width` nodes an axis (2, 3 or 4).
template <int D, class T>
TileKernels<D, T> tile_kernels(int width);

constexpr int quad_groups(int dimension, bool affine, bool gradient) {
  return 1 + (affine ? dimension : 0) + (gradient ? dimension : 0);
}

// ---- implementation ----------------------------------------------------------------------------------------------

template <int D, int K>
inline constexpr int tile_side = block_side<D> + K + 1;

/// Weights of one particle along one axis.
template <int K, bool Gradient, class T>
struct AxisWeights {
  T w[K], g[K];
  AxisWeights(const Stencils<T>& stencils, int axis, int particle) {
    for (int k = 0; k < K; ++k) w[k] = stencils.weight[(axis * K + k) * chunk_size + particle];
    if constexpr (Gradient)
      for (int k = 0; k < K; ++k) g[k] = stencils.gradient[(axis * K + k) * chunk_size + particle];
  }
};

/// One row of nodes along the last axis: node k gets w_k (c + k q) + g_k s.
template <int K, bool Affine, bool Gradient, class T>
inline __attribute__((always_inline)) void add_row(Quad<T>* row, const AxisWeights<K, Gradient, T>& last, Quad<T> c,
                                                   Quad<T> q, Quad<T> s) {
#pragma GCC unroll 4
  for (int k = 0; k < K; ++k) {
    Quad<T> value = row[k] + last.w[k] * c;
    if constexpr (Affine) {
      if (k > 0) value += (T(k) * last.w[k]) * q;
    }
    if constexpr (Gradient) value += last.g[k] * s;
    row[k] = value;
  }
}

template <int D, class T, int K, bool Affine, bool Gradient>
void scatter_to_tile(T* tile, const Stencils<T>& stencils, const T* coefficients, int count) {
  using Q = Quad<T>;
  constexpr int groups = quad_groups(D, Affine, Gradient), side = tile_side<D, K>;
  constexpr int first_s = 1 + (Affine ? D : 0);
  for (int p = 0; p < count; ++p) {
    const Q* const c = reinterpret_cast<const Q*>(coefficients) + p * groups;
    Q* const corner = reinterpret_cast<Q*>(tile) + stencils.tile_node[p];
    const AxisWeights<K, Gradient, T> x(stencils, 0, p), last(stencils, D - 1, p);
    Q q[3]{}, s[3]{};
    if constexpr (Affine)
      for (int a = 0; a < D; ++a) q[a] = c[1 + a];
    if constexpr (Gradient)
      for (int a = 0; a < D; ++a) s[a] = c[first_s + a];
    Q plane = c[0];  // b' + i Q_x
#pragma GCC unroll 4
    for (int i = 0; i < K; ++i) {
      Q ci = x.w[i] * plane;
      if constexpr (Gradient) ci += x.g[i] * s[0];
      if constexpr (Affine) plane += q[0];
      if constexpr (D == 2) {
        add_row<K, Affine, Gradient, T>(corner + i * side, last, ci, x.w[i] * q[1], x.w[i] * s[1]);
      } else {
        const AxisWeights<K, Gradient, T> y(stencils, 1, p);
        const Q qy = x.w[i] * q[1], qz = x.w[i] * q[2], sy = x.w[i] * s[1], sz = x.w[i] * s[2];
#pragma GCC unroll 4
        for (int j = 0; j < K; ++j) {
          Q cij = y.w[j] * ci;
          if constexpr (Gradient) cij += y.g[j] * sy;
          if constexpr (Affine) ci += qy;
          add_row<K, Affine, Gradient, T>(corner + (i * side + j) * side, last, cij, y.w[j] * qz, y.w[j] * sz);
        }
      }
    }
  }
}

/// Sums over one row: of w v, k w v and g v.
template <class T>
struct RowSums {
  Quad<T> value{}, moment{}, gradient{};
};
template <int K, bool Moment, bool Gradient, class T>
inline __attribute__((always_inline)) RowSums<T> row_sums(const Quad<T>* row, const AxisWeights<K, Gradient, T>& last) {
  RowSums<T> sum;
  sum.value = last.w[0] * row[0];
  if constexpr (Gradient) sum.gradient = last.g[0] * row[0];
#pragma GCC unroll 4
  for (int k = 1; k < K; ++k) {
    const Quad<T> term = last.w[k] * row[k];
    sum.value += term;
    if constexpr (Moment) sum.moment += T(k) * term;
    if constexpr (Gradient) sum.gradient += last.g[k] * row[k];
  }
  return sum;
}

template <int D, class T, int K, bool Moment, bool Gradient>
void gather_from_tile(const T* tile, const Stencils<T>& stencils, T* moments, int count) {
  using Q = Quad<T>;
  constexpr int groups = quad_groups(D, Moment, Gradient), side = tile_side<D, K>;
  constexpr int first_g = 1 + (Moment ? D : 0);
  for (int p = 0; p < count; ++p) {
    const Q* const corner = reinterpret_cast<const Q*>(tile) + stencils.tile_node[p];
    const AxisWeights<K, Gradient, T> x(stencils, 0, p), last(stencils, D - 1, p);
    Q value{}, m[3]{}, g[3]{};
#pragma GCC unroll 4
    for (int i = 0; i < K; ++i) {
      Q plane, plane_m[3]{}, plane_g[3]{};  // sums over the plane i
      if constexpr (D == 2) {
        const RowSums<T> row = row_sums<K, Moment, Gradient, T>(corner + i * side, last);
        plane = row.value, plane_m[1] = row.moment, plane_g[1] = row.gradient;
      } else {
        const AxisWeights<K, Gradient, T> y(stencils, 1, p);
        plane = Q{};
#pragma GCC unroll 4
        for (int j = 0; j < K; ++j) {
          const RowSums<T> row = row_sums<K, Moment, Gradient, T>(corner + (i * side + j) * side, last);
          const Q term = y.w[j] * row.value;
          plane += term;
          if constexpr (Moment) {
            if (j > 0) plane_m[1] += T(j) * term;
            plane_m[2] += y.w[j] * row.moment;
          }
          if constexpr (Gradient) {
            plane_g[1] += y.g[j] * row.value;
            plane_g[2] += y.w[j] * row.gradient;
          }
        }
      }
      const Q term = x.w[i] * plane;
      value += term;
      if constexpr (Moment) {
        if (i > 0) m[0] += T(i) * term;
        for (int a = 1; a < D; ++a) m[a] += x.w[i] * plane_m[a];
      }
      if constexpr (Gradient) {
        g[0] += x.g[i] * plane;
        for (int a = 1; a < D; ++a) g[a] += x.w[i] * plane_g[a];
      }
    }
    Q* const out = reinterpret_cast<Q*>(moments) + p * groups;
    out[0] = value;
    if constexpr (Moment)
      for (int a = 0; a < D; ++a) out[1 + a] = m[a];
    if constexpr (Gradient)
      for (int a = 0; a < D; ++a) out[first_g + a] = g[a];
  }
}

/// Calls run(tile node, grid node, length) for the runs of consecutive nodes that the reach touches.
template <int D, int K, class Run>
inline void for_each_run(const std::int32_t* neighbours, const Reach& reach, Run&& run) {
  constexpr int B = block_side<D>, side = tile_side<D, K>;
  const auto row = [&](int tile_row, int neighbour, int block_row) {  // split at the faces of blocks
    for (int z = reach.lowest[D - 1]; z < reach.highest[D - 1] + K;) {
      const int along = z - 1, part = along < 0 ? 0 : along < B ? 1 : 2;
      const int end = part == 0 ? 1 : part == 1 ? 1 + B : side;
      const int stop = end < reach.highest[D - 1] + K ? end : reach.highest[D - 1] + K;
      run(tile_row + z, std::size_t(neighbours[neighbour + part]) * block_nodes + block_row + (along & (B - 1)),
          stop - z);
      z = stop;
    }
  };
  for (int i = reach.lowest[0]; i < reach.highest[0] + K; ++i) {
    const int x = i - 1, block_x = x < 0 ? 0 : x < B ? 1 : 2, local_x = x & (B - 1);
    if constexpr (D == 2) {
      row(i * side, block_x * 3, local_x * B);
    } else {
      for (int j = reach.lowest[1]; j < reach.highest[1] + K; ++j) {
        const int y = j - 1, block_y = y < 0 ? 0 : y < B ? 1 : 2, local_y = y & (B - 1);
        row((i * side + j) * side, (block_x * 3 + block_y) * 3, (local_x * B + local_y) * B);
      }
    }
  }
}

template <int D, class T, int K>
void load_tile(T* tile, const T* channel, const std::int32_t* neighbours, const Reach& reach) {
  using Q = Quad<T>;
  for_each_run<D, K>(neighbours, reach, [&](int node, std::size_t grid_node, int length) {
    for (int k = 0; k < length; ++k)
      reinterpret_cast<Q*>(tile)[node + k] = reinterpret_cast<const Q*>(channel)[grid_node + k];
  });
}

template <int D, class T, int K>
void flush_tile(T* tile, T* channel, const std::int32_t* neighbours, const Reach& reach) {
  using Q = Quad<T>;
  for_each_run<D, K>(neighbours, reach, [&](int node, std::size_t grid_node, int length) {
    for (int k = 0; k < length; ++k) {
      reinterpret_cast<Q*>(channel)[grid_node + k] += reinterpret_cast<Q*>(tile)[node + k];
      reinterpret_cast<Q*>(tile)[node + k] = Q{};
    }
  });
}

template <int D, class T, int K>
TileKernels<D, T> tile_kernels_of_width() {
  TileKernels<D, T> kernels;
  kernels.side = tile_side<D, K>;
  kernels.nodes = D == 3 ? kernels.side * kernels.side * kernels.side : kernels.side * kernels.side;
  kernels.scatter[0][0] = &scatter_to_tile<D, T, K, false, false>;
  kernels.scatter[0][1] = &scatter_to_tile<D, T, K, false, true>;
  kernels.scatter[1][0] = &scatter_to_tile<D, T, K, true, false>;
  kernels.scatter[1][1] = &scatter_to_tile<D, T, K, true, true>;
  kernels.gather[0][0] = &gather_from_tile<D, T, K, false, false>;
  kernels.gather[0][1] = &gather_from_tile<D, T, K, false, true>;
  kernels.gather[1][0] = &gather_from_tile<D, T, K, true, false>;
  kernels.gather[1][1] = &gather_from_tile<D, T, K, true, true>;
  kernels.load = &load_tile<D, T, K>;
  kernels.flush = &flush_tile<D, T, K>;
  return kernels;
}

}  // namespace mpm::cpu
