#pragma once
// These kernels scatter and gather for list shapes: by dense boxes of weights in the tile of a block (particles whose
// nodes fit), and by lists of nodes in the tile or on the grid (the others). A node's weight is broadcast from memory
// beside one quad: wider stores overlap by a shift from one particle to the next, which stalls the loads that follow.

#include <cstdint>

#include "backends/cpu/tiles/quad.hpp"
#include "backends/cpu/tiles/tile.hpp"
#include "plugin/extensions.h"

namespace mpm::cpu {

inline constexpr int box_width = MPM_BOX_WIDTH;
/// The number of quads from one group of a particle's to the next.
template <class T>
inline constexpr int quad_step = quad_group<T> / 4;
template <int D>
inline constexpr int box_nodes = D == 2 ? box_width* box_width : box_width* box_width* box_width;
/// The nodes an axis of the tile that lists and boxes are scattered to.
template <int D>
inline constexpr int list_tile_side = tile_side<D, box_width>;

/// The boxes of one chunk.
template <class T>
struct Boxes {
  const std::int32_t* width;      ///< nodes an axis that are used, 3 or 4; 0 where the particle has a list
  const std::int32_t* tile_node;  ///< first node in the tile
  const T* weight;                ///< [box_nodes][chunk_size]
  const T* gradient;              ///< [D][box_nodes][chunk_size], per cell
};

/// The lists of nodes of one chunk, one after another: those of particle p are entries first[p] to last[p].
template <class T>
struct NodeLists {
  const std::int32_t *first, *last;
  const std::int32_t* node;  ///< [entry] in the tile, or in a channel of the grid
  const T* values;           ///< [entry][8] d (cells, node - particle), w | gradient (per cell), unused
};

/// Coefficients and moments are quads as in TileKernels; those of a list count from the particle: b' = b. Particles
/// without a box, or without an entry, are left alone.
template <int D, class T>
struct ListKernels {
  using ScatterBoxes = void (*)(T* tile, const Boxes<T>&, const T* coefficients, int count);
  using GatherBoxes = void (*)(const T* tile, const Boxes<T>&, T* moments, int count);
  using ScatterLists = void (*)(T* nodes, const NodeLists<T>&, const T* coefficients, int count);
  using GatherLists = void (*)(const T* nodes, const NodeLists<T>&, T* moments, int count);
  ScatterBoxes scatter_boxes[2][2];  ///< [affine][gradient]
  GatherBoxes gather_boxes[2][2];    ///< [moment][gradient]
  ScatterLists scatter_lists[2][2];
  GatherLists gather_lists[2][2];
};

template <int D, class T>
ListKernels<D, T> list_kernels();

// ---- implementation ----------------------------------------------------------------------------------------------

/// Gives node (i, j, k)  w (b' + i Q_x + j Q_y + k Q_z) + g_x S_x + g_y S_y + g_z S_z.
template <int D, class T, int W, bool Affine, bool Gradient>
inline __attribute__((always_inline)) void scatter_box(Quad<T>* corner, const T* weight, const T* gradient,
                                                       const Quad<T>* coefficients) {
  using Q = Quad<T>;
  constexpr int side = list_tile_side<D>, rows = D == 2 ? 1 : W, first_s = 1 + (Affine ? D : 0);
  Q c[quad_groups(D, Affine, Gradient)];  // it is in registers, whatever the stores to the tile may reach
  for (int k = 0; k < quad_groups(D, Affine, Gradient); ++k) c[k] = coefficients[k * quad_step<T>];
  Q plane = c[0];
  for (int i = 0; i < W; ++i) {
    Q row = plane;
#pragma GCC unroll 4
    for (int j = 0; j < rows; ++j) {
      Q* const nodes = corner + (i * (D == 2 ? 1 : side) + j) * side;
      const int first = (i * (D == 2 ? 1 : box_width) + j) * box_width * chunk_size<T>;
      Q value = row;
#pragma GCC unroll 4
      for (int k = 0; k < W; ++k) {
        const int at = first + k * chunk_size<T>;
        Q sum = nodes[k] + weight[at] * value;
        if constexpr (Gradient)
#pragma GCC unroll 4
          for (int a = 0; a < D; ++a) sum += gradient[a * box_nodes<D> * chunk_size<T> + at] * c[first_s + a];
        nodes[k] = sum;
        if constexpr (Affine) value += c[D];
      }
      if constexpr (Affine && D == 3) row += c[2];
    }
    if constexpr (Affine) plane += c[1];
  }
}

template <int D, class T, bool Affine, bool Gradient>
void scatter_boxes(T* tile, const Boxes<T>& boxes, const T* coefficients, int count) {
  using Q = Quad<T>;
  constexpr int groups = quad_groups(D, Affine, Gradient);
  for (int p = 0; p < count; ++p) {
    const Q* const c = reinterpret_cast<const Q*>(coefficients + quad_place<T>(p, groups));
    Q* const corner = reinterpret_cast<Q*>(tile) + boxes.tile_node[p];
    if (boxes.width[p] == 3)
      scatter_box<D, T, 3, Affine, Gradient>(corner, boxes.weight + p, boxes.gradient + p, c);
    else if (boxes.width[p] == 4)
      scatter_box<D, T, 4, Affine, Gradient>(corner, boxes.weight + p, boxes.gradient + p, c);
  }
}

/// Sums  w v,  k_a w v  and  g_a v  over the nodes.
template <int D, class T, int W, bool Moment, bool Gradient>
inline __attribute__((always_inline)) void gather_box(const Quad<T>* corner, const T* weight, const T* gradient,
                                                      Quad<T>* out) {
  using Q = Quad<T>;
  constexpr int side = list_tile_side<D>, rows = D == 2 ? 1 : W, first_g = 1 + (Moment ? D : 0);
  Q value{}, m[3]{}, g[3]{};
#pragma GCC unroll 4
  for (int i = 0; i < W; ++i) {
    Q plane{};
#pragma GCC unroll 4
    for (int j = 0; j < rows; ++j) {
      const Q* const nodes = corner + (i * (D == 2 ? 1 : side) + j) * side;
      const int first = (i * (D == 2 ? 1 : box_width) + j) * box_width * chunk_size<T>;
      Q row{}, row_m{}, row_g[3]{};  // chains of additions stay short
#pragma GCC unroll 4
      for (int k = 0; k < W; ++k) {
        const int at = first + k * chunk_size<T>;
        const Q v = nodes[k], term = weight[at] * v;
        row += term;
        if constexpr (Moment) {
          if (k > 0) row_m += T(k) * term;
        }
        if constexpr (Gradient)
#pragma GCC unroll 4
          for (int a = 0; a < D; ++a) row_g[a] += gradient[a * box_nodes<D> * chunk_size<T> + at] * v;
      }
      plane += row;
      if constexpr (Moment) m[D - 1] += row_m;
      if constexpr (Gradient)
        for (int a = 0; a < D; ++a) g[a] += row_g[a];
      if constexpr (Moment && D == 3) {
        if (j > 0) m[1] += T(j) * row;
      }
    }
    value += plane;
    if constexpr (Moment) {
      if (i > 0) m[0] += T(i) * plane;
    }
  }
  out[0] = value;
  if constexpr (Moment)
    for (int a = 0; a < D; ++a) out[(1 + a) * quad_step<T>] = m[a];
  if constexpr (Gradient)
    for (int a = 0; a < D; ++a) out[(first_g + a) * quad_step<T>] = g[a];
}

template <int D, class T, bool Moment, bool Gradient>
void gather_boxes(const T* tile, const Boxes<T>& boxes, T* moments, int count) {
  using Q = Quad<T>;
  constexpr int groups = quad_groups(D, Moment, Gradient);
  for (int p = 0; p < count; ++p) {
    const Q* const corner = reinterpret_cast<const Q*>(tile) + boxes.tile_node[p];
    Q* const out = reinterpret_cast<Q*>(moments + quad_place<T>(p, groups));
    if (boxes.width[p] == 3)
      gather_box<D, T, 3, Moment, Gradient>(corner, boxes.weight + p, boxes.gradient + p, out);
    else if (boxes.width[p] == 4)
      gather_box<D, T, 4, Moment, Gradient>(corner, boxes.weight + p, boxes.gradient + p, out);
  }
}

/// Gives a list's nodes  w (b + d_x Q_x + d_y Q_y + d_z Q_z) + g_x S_x + g_y S_y + g_z S_z.
template <int D, class T, bool Affine, bool Gradient>
void scatter_lists(T* nodes, const NodeLists<T>& lists, const T* coefficients, int count) {
  using Q = Quad<T>;
  constexpr int groups = quad_groups(D, Affine, Gradient), first_s = 1 + (Affine ? D : 0);
  for (int p = 0; p < count; ++p) {
    const Q* const c = reinterpret_cast<const Q*>(coefficients + quad_place<T>(p, groups));
    for (std::int32_t e = lists.first[p]; e < lists.last[p]; ++e) {
      const T* const entry = lists.values + std::size_t(e) * 8;
      Q sum = c[0];
      if constexpr (Affine)
        for (int a = 0; a < D; ++a) sum += entry[a] * c[(1 + a) * quad_step<T>];
      Q value = entry[3] * sum;
      if constexpr (Gradient)
        for (int a = 0; a < D; ++a) value += entry[4 + a] * c[(first_s + a) * quad_step<T>];
      reinterpret_cast<Q*>(nodes)[lists.node[e]] += value;
    }
  }
}

/// Sums w v, d_a w v and g_a v over a list.
template <int D, class T, bool Moment, bool Gradient>
void gather_lists(const T* nodes, const NodeLists<T>& lists, T* moments, int count) {
  using Q = Quad<T>;
  constexpr int groups = quad_groups(D, Moment, Gradient), first_g = 1 + (Moment ? D : 0);
  for (int p = 0; p < count; ++p) {
    if (lists.first[p] == lists.last[p]) continue;
    Q value{}, m[3]{}, g[3]{};
    for (std::int32_t e = lists.first[p]; e < lists.last[p]; ++e) {
      const T* const entry = lists.values + std::size_t(e) * 8;
      const Q v = reinterpret_cast<const Q*>(nodes)[lists.node[e]], term = entry[3] * v;
      value += term;
      if constexpr (Moment)
        for (int a = 0; a < D; ++a) m[a] += entry[a] * term;
      if constexpr (Gradient)
        for (int a = 0; a < D; ++a) g[a] += entry[4 + a] * v;
    }
    Q* const out = reinterpret_cast<Q*>(moments + quad_place<T>(p, groups));
    out[0] = value;
    if constexpr (Moment)
      for (int a = 0; a < D; ++a) out[(1 + a) * quad_step<T>] = m[a];
    if constexpr (Gradient)
      for (int a = 0; a < D; ++a) out[(first_g + a) * quad_step<T>] = g[a];
  }
}

template <int D, class T, bool First, bool Gradient>
void set_list_kernels(ListKernels<D, T>& kernels) {
  kernels.scatter_boxes[First][Gradient] = &scatter_boxes<D, T, First, Gradient>;
  kernels.gather_boxes[First][Gradient] = &gather_boxes<D, T, First, Gradient>;
  kernels.scatter_lists[First][Gradient] = &scatter_lists<D, T, First, Gradient>;
  kernels.gather_lists[First][Gradient] = &gather_lists<D, T, First, Gradient>;
}

template <int D, class T>
ListKernels<D, T> list_kernels_of() {
  ListKernels<D, T> kernels;
  set_list_kernels<D, T, false, false>(kernels);
  set_list_kernels<D, T, false, true>(kernels);
  set_list_kernels<D, T, true, false>(kernels);
  set_list_kernels<D, T, true, true>(kernels);
  return kernels;
}

}  // namespace mpm::cpu

/// What instantiation.cpp.in makes of this header for every dimension and scalar.
#define MPM_INSTANTIATE_BOX_KERNELS(D, T)  \
  template <>                              \
  ListKernels<D, T> list_kernels<D, T>() { \
    return list_kernels_of<D, T>();        \
  }
