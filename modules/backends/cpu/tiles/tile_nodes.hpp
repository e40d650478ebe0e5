#pragma once
// Tiles take nodes from the grid and give them back, line by line along the last axis; their kernels are listed here.

#include <stdexcept>

#include "backends/cpu/tiles/tile.hpp"

namespace mpm::cpu {

/// A row of a tile along the last axis, and the rows of three blocks in a line that it crosses.
template <int D>
struct TileRow {
  int number = 0;     ///< number in the tile
  int neighbour = 0;  ///< first of the three blocks
  int block_row = 0;  ///< first node of the row within a block
};

/// Calls visit(row) for the rows that the reach touches.
template <int D, int K, class Visit>
inline void for_each_row(const Reach& reach, Visit&& visit) {
  constexpr int B = block_side<D>, side = tile_side<D, K>;
  for (int i = reach.lowest[0]; i < reach.highest[0] + K; ++i) {
    const int x = i - 1, block_x = x < 0 ? 0 : x < B ? 1 : 2, local_x = x & (B - 1);
    if constexpr (D == 2) {
      visit(TileRow<D>{i, block_x * 3, local_x * B});
    } else {
      for (int j = reach.lowest[1]; j < reach.highest[1] + K; ++j) {
        const int y = j - 1, block_y = y < 0 ? 0 : y < B ? 1 : 2, local_y = y & (B - 1);
        visit(TileRow<D>{i * side + j, (block_x * 3 + block_y) * 3, (local_x * B + local_y) * B});
      }
    }
  }
}

/// Says which of the three blocks in a line a tile's rows share nodes with, and finds the grid's nodes there. A row is
/// the last node of the first block, all of the second's and the first K of the third's.
template <int D, int K>
struct Line {
  bool first, third;
  explicit Line(const Reach& reach)
      : first(reach.lowest[D - 1] == 0), third(reach.highest[D - 1] + K - 1 > block_side<D>) {}

  /// Calls run(node of the row, node of the grid, number of nodes as a constant).
  template <class Run>
  MPM_ROW_INLINE void for_each_run(const TileRow<D>& row, const std::int32_t* neighbours, Run&& run) const {
    constexpr int B = block_side<D>;
    const auto node = [&](int part) {
      return std::size_t(neighbours[row.neighbour + part]) * block_nodes + row.block_row;
    };
    if (first) run(0, node(0) + B - 1, std::integral_constant<int, 1>());
    run(1, node(1), std::integral_constant<int, B>());
    if (third) run(B + 1, node(2), std::integral_constant<int, K>());
  }
};

/// The nodes of three blocks in a line at which a tile's rows begin and end, as registers: four of the first block, all
/// of the second's, four of the third.
template <int D, class T, int K>
struct LineOfNodes {
  using R = Row<T, K>;
  using V = typename R::Vector;
  static constexpr int B = block_side<D>, beside = 4 / R::nodes_a_vector, own = B / R::nodes_a_vector;
  V nodes[beside + own + beside]{};

  MPM_ROW_INLINE LineOfNodes(const T* channel, const std::int32_t* neighbours, const TileRow<D>& row, bool first,
                             bool third) {
    const auto load = [&](int part, int node, int count, V* to) {
      const T* const from = channel + (std::size_t(neighbours[part]) * block_nodes + row.block_row + node) * 4;
      for (int i = 0; i < count; ++i) to[i] = *reinterpret_cast<const typename R::Unaligned*>(from + i * R::width);
    };
    if (first) load(row.neighbour, B - 4, beside, nodes);
    load(row.neighbour + 1, 0, own, nodes + beside);
    if (third) load(row.neighbour + 2, 0, beside, nodes + beside + own);
  }

  /// The row whose first node is the z-th that a stencil may begin with.
  template <int z>
  MPM_ROW_INLINE R row() const {
    constexpr int node = 3 + z, shift = node % R::nodes_a_vector;
    R row;
    for (int i = 0; i < R::vectors; ++i) {
      const V* const from = nodes + node / R::nodes_a_vector + i;
      if constexpr (shift == 0)
        row.v[i] = from[0];
      else
        row.v[i] =
            shuffled<[](int lane) { return lane + 4 * shift; }>(from[0], from[1], std::make_index_sequence<R::width>());
    }
    return row;
  }
};

template <int D, class T, int K>
void load_rows(T* tile, const T* channel, const std::int32_t* neighbours, const Reach& reach) {
  using R = Row<T, K>;
  constexpr int rows = first_nodes_of_tile<D>;
  const Line<D, K> line(reach);
  const int lowest = reach.lowest[D - 1], highest = reach.highest[D - 1];
  for_each_row<D, K>(reach, [&](const TileRow<D>& row) {
    const LineOfNodes<D, T, K> nodes(channel, neighbours, row, line.first, line.third);
    T* const to = tile + std::size_t(row.number) * rows * R::scalars;
    [&]<int... z>(std::integer_sequence<int, z...>) {
      ((z < lowest || z > highest ? void() : store_row(to + z * R::scalars, nodes.template row<z>())), ...);
    }
    (std::make_integer_sequence<int, rows>());
  });
}

/// Loads the nodes themselves, for lists.
template <int D, class T, int K>
void load_nodes(T* tile, const T* channel, const std::int32_t* neighbours, const Reach& reach) {
  using Q = Quad<T>;
  const Line<D, K> line(reach);
  for_each_row<D, K>(reach, [&](const TileRow<D>& row) {
    Q* const to = reinterpret_cast<Q*>(tile) + row.number * tile_side<D, K>;
    line.for_each_run(row, neighbours, [&](int z, std::size_t grid_node, auto length) {
      const Q* const from = reinterpret_cast<const Q*>(channel) + grid_node;
      for (int k = 0; k < length; ++k) to[z + k] = from[k];
    });
  });
}

template <int D, class T, int K>
void flush_nodes(T* tile, T* channel, const std::int32_t* neighbours, const Reach& reach) {
  using Q = Quad<T>;
  const Line<D, K> line(reach);
  for_each_row<D, K>(reach, [&](const TileRow<D>& row) {
    Q* const from = reinterpret_cast<Q*>(tile) + row.number * tile_side<D, K>;
    line.for_each_run(row, neighbours, [&](int z, std::size_t grid_node, auto length) {
      Q* const to = reinterpret_cast<Q*>(channel) + grid_node;
      for (int k = 0; k < length; ++k) {
        to[k] += from[z + k];
        from[z + k] = Q{};
      }
    });
  });
}

/// Adds up the rows of each first node along the last axis.
template <int D, class T, int K>
void flush_rows(T* tile, T* channel, const std::int32_t* neighbours, const Reach& reach) {
  using Q = Quad<T>;
  using R = Row<T, K>;
  constexpr int rows = first_nodes_of_tile<D>;
  const Line<D, K> line(reach);
  for_each_row<D, K>(reach, [&](const TileRow<D>& row) {
    T* const first = tile + std::size_t(row.number) * rows * R::scalars;
    line.for_each_run(row, neighbours, [&](int z, std::size_t grid_node, auto length) {
      Q* const to = reinterpret_cast<Q*>(channel) + grid_node;
      for (int n = 0; n < length; ++n) {
        Q sum = to[n];
#pragma GCC unroll 4
        for (int k = 0; k < K; ++k)
          if (z + n - k >= 0 && z + n - k < rows)
            sum += reinterpret_cast<const Q*>(first + (z + n - k) * R::scalars)[k];
        to[n] = sum;
      }
    });
    for (int z = 0; z < rows; ++z) store_row(first + z * R::scalars, R{});
  });
}

constexpr int rows_of_tile(int dimension, int side) {
  return dimension == 3 ? side * side : side;
}

template <int D, class T, int K>
TileKernels<D, T> tile_kernels_of_width() {
  TileKernels<D, T> kernels;
  kernels.side = tile_side<D, K>;
  kernels.first_nodes = first_nodes_of_tile<D>;
  kernels.scalars = rows_of_tile(D, kernels.side) * kernels.first_nodes * Row<T, K>::scalars;
  kernels.scatter[0][0] = &scatter_to_tile<D, T, K, false, false>;
  kernels.scatter[0][1] = &scatter_to_tile<D, T, K, false, true>;
  kernels.scatter[1][0] = &scatter_to_tile<D, T, K, true, false>;
  kernels.scatter[1][1] = &scatter_to_tile<D, T, K, true, true>;
  kernels.gather[0][0] = &gather_from_tile<D, T, K, false, false>;
  kernels.gather[0][1] = &gather_from_tile<D, T, K, false, true>;
  kernels.gather[1][0] = &gather_from_tile<D, T, K, true, false>;
  kernels.gather[1][1] = &gather_from_tile<D, T, K, true, true>;
  kernels.load = &load_rows<D, T, K>;
  kernels.flush = &flush_rows<D, T, K>;
  return kernels;
}

template <int D, class T>
TileKernels<D, T> choose_tile_kernels(int width) {
  if (width == 2) return tile_kernels_of_width<D, T, 2>();
  if (width == 3) return tile_kernels_of_width<D, T, 3>();
  if (width == 4) return tile_kernels_of_width<D, T, 4>();
  throw std::invalid_argument("the cpu backend takes shapes of 2, 3 or 4 nodes an axis");
}

template <int D, class T>
TileKernels<D, T> tiles_of_lists() {
  constexpr int K = 4;
  TileKernels<D, T> kernels;
  kernels.side = kernels.first_nodes = tile_side<D, K>;
  kernels.scalars = rows_of_tile(D, kernels.side) * kernels.side * 4;
  kernels.load = &load_nodes<D, T, K>;
  kernels.flush = &flush_nodes<D, T, K>;
  return kernels;
}

}  // namespace mpm::cpu

/// What instantiation.cpp.in makes of this header for every dimension and scalar.
#define MPM_INSTANTIATE_TILE(D, T)                  \
  template <>                                       \
  TileKernels<D, T> tile_kernels<D, T>(int width) { \
    return choose_tile_kernels<D, T>(width);        \
  }                                                 \
  template <>                                       \
  TileKernels<D, T> tile_kernels_of_lists<D, T>() { \
    return tiles_of_lists<D, T>();                  \
  }
