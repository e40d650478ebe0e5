#pragma once
// These kernels scatter and gather between one chunk of particles and the tile of nodes around its block, specialised
// at compile time.
//
// A tile is the block with one cell of drift on each side and the reach of the stencil: (side + K + 1)^D nodes of one
// quad. Coefficients of a particle are quads: [b' | Q_a, a < D (affine) | S_a, a < D (gradient)], and a node (i, j, k)
// of its stencil gets
//   w_i w_j w_k (b' + i Q_x + j Q_y + k Q_z) + grad terms,    b' = b - h A f,  Q_a = h A e_a,  S_a = S e_a / h.
// The gather returns in the same places  sum w v,  sum k_a w v  and  sum (dw/dx_a) v.
//
// Both work on whole rows of nodes along the last axis (row.hpp). A tile holds a row of its own for every first node
// along that axis: what one particle scatters the next one loads at the same address (rows that overlap wait for one
// another in the store buffer), and no load crosses a line of the cache. The flush adds the rows up.

#include <cstdint>
#include <type_traits>

#include "backends/cpu/grid/blocks.hpp"
#include "backends/cpu/tiles/row.hpp"

namespace mpm::cpu {

/// Memory to bring into the cache while the particles are worked on, a little with each: all at once would fill the
/// queue of misses and stop the work.
struct Ahead {
  const char* from = nullptr;
  std::size_t first = 0, bytes_a_particle = 0;
  std::size_t gap_at = ~std::size_t(0), gap = 0;  ///< bytes that are left out, and where
  MPM_ROW_INLINE void fetch(int particle) const {
    const std::size_t begin = first + particle * bytes_a_particle;
    for (std::size_t byte = begin; byte < begin + bytes_a_particle; byte += 64)
      __builtin_prefetch(from + byte + (byte < gap_at ? 0 : gap), 1, 3);
  }
};

/// The weights of one chunk, in arrays [axis * K + k][chunk_size].
template <class T>
struct Stencils {
  const std::int32_t* first;  ///< row of the stencil in the tile
  bool shared = false;        ///< most particles have the stencil of the one before
  const T* weight;
  const T* gradient;  ///< per cell
  Ahead ahead;
};

/// The part of a tile that its particles reach: first nodes of stencils, from the tile's corner.
struct Reach {
  int lowest[3] = {1 << 20, 1 << 20, 1 << 20}, highest[3] = {-1, -1, -1};
};

template <int D, class T>
struct TileKernels {
  using Scatter = void (*)(T* tile, const Stencils<T>&, const T* coefficients, int count);
  using Gather = void (*)(const T* tile, const Stencils<T>&, T* moments, int count);
  int side = 0;             ///< nodes an axis
  int first_nodes = 0;      ///< first nodes along the last axis: rows of the tile beside one another
  int scalars = 0;          ///< number of scalars of a tile
  Scatter scatter[2][2]{};  ///< [affine][gradient]
  Gather gather[2][2]{};    ///< [moment][gradient]; for whole packs of particles
  void (*load)(T* tile, const T* channel, const std::int32_t* neighbours, const Reach&);
  void (*flush)(T* tile, T* channel, const std::int32_t* neighbours, const Reach&);  ///< adds, and clears the tile
};

/// Gives the kernels for a stencil of `width` nodes an axis (2, 3 or 4).
template <int D, class T>
TileKernels<D, T> tile_kernels(int width);
/// Gives tiles without kernels for lists of nodes (box_kernels.hpp), which are scattered to nodes and not to rows.
template <int D, class T>
TileKernels<D, T> tile_kernels_of_lists();

constexpr int quad_groups(int dimension, bool affine, bool gradient) {
  return 1 + (affine ? dimension : 0) + (gradient ? dimension : 0);
}

// ---- implementation ----------------------------------------------------------------------------------------------

template <int D, int K>
inline constexpr int tile_side = block_side<D> + K + 1;
/// The number of first nodes that stencils in a tile may have, an axis.
template <int D>
inline constexpr int first_nodes_of_tile = block_side<D> + 2;

/// The weights of one particle along an axis other than the last, each on all of a register: they are loaded so before
/// anything is stored.
template <int K, class T>
struct AxisWeights {
  typename Row<T, K>::Vector w[K], g[K];
  MPM_ROW_INLINE AxisWeights(const Stencils<T>& stencils, int axis, int particle, bool gradient) {
    for (int k = 0; k < K; ++k) w[k] = broadcast<T, K>(stencils.weight[(axis * K + k) * chunk_size<T> + particle]);
    if (gradient)
      for (int k = 0; k < K; ++k) g[k] = broadcast<T, K>(stencils.gradient[(axis * K + k) * chunk_size<T> + particle]);
  }
};

/// The weights along the last axis, one quad a particle.
template <int D, int K, class T>
struct LastWeights {
  alignas(64) T quads[chunk_size<T> * 4];
  MPM_ROW_INLINE LastWeights(const T* weights, int count) {
    const T* const w = weights + (D - 1) * K * chunk_size<T>;
    for (int p = 0; p < count; p += Lanes<T>::width) {
      Lanes<T> components[4];
      for (int k = 0; k < 4; ++k) components[k] = k < K ? Lanes<T>::load(w + k * chunk_size<T> + p) : Lanes<T>(T(0));
      store_quads<T>(quads + 4 * p, components);
    }
  }
  MPM_ROW_INLINE Row<T, K> row(std::ptrdiff_t place) const { return spread<T, K>(quads + place); }
};

/// The rows of one stencil. Where particles share it and registers are enough, these keep the rows from one particle to
/// the next; otherwise each particle loads and stores them, as a branch that nobody can foresee costs more.
template <int D, int K, class T, bool Shared, bool Gradient>
struct StencilRows {
  using R = Row<T, K>;
  static constexpr int count = D == 2 ? K : K * K;
  static constexpr int others = Gradient ? 20 : 12;  // registers that a particle's sums and coefficients want
  static constexpr bool kept = Shared && count * R::vectors + others <= vector_registers;

  R row[kept ? count : 1];

  /// The place of the k-th row, where rows lie `line` scalars apart.
  static MPM_ROW_INLINE int place(int k, int line) {
    return D == 2 ? k * line : (k / K * tile_side<D, K> + k % K) * line;
  }
  MPM_ROW_INLINE void load(const T* corner, int line) {
#pragma GCC unroll 16
    for (int k = 0; kept && k < count; ++k) row[k] = load_row<T, K>(corner + place(k, line));
  }
  MPM_ROW_INLINE void store(T* corner, int line) const {
#pragma GCC unroll 16
    for (int k = 0; kept && k < count; ++k) store_row(corner + place(k, line), row[k]);
  }
  MPM_ROW_INLINE R get(int k, const T* corner, int line) const {
    if constexpr (kept) return row[k];
    return load_row<T, K>(corner + place(k, line));
  }
  MPM_ROW_INLINE void set(int k, const R& value, T* corner, int line) {
    if constexpr (kept)
      row[k] = value;
    else
      store_row(corner + place(k, line), value);
  }
};

template <int D, class T, int K, bool Affine, bool Gradient, bool Shared>
void scatter_particles(T* tile, const Stencils<T>& stencils, const T* coefficients, int count) {
  using R = Row<T, K>;
  constexpr int groups = quad_groups(D, Affine, Gradient), first_s = 1 + (Affine ? D : 0);
  const LastWeights<D, K, T> weights(stencils.weight, count);
  const LastWeights<D, K, T> slopes(Gradient ? stencils.gradient : stencils.weight, Gradient ? count : 0);
  const R number = node_numbers<T, K>();
  constexpr int line = first_nodes_of_tile<D> * R::scalars;
  StencilRows<D, K, T, Shared, Gradient> rows;
  T* corner = nullptr;
  const T* pack = coefficients;
  std::ptrdiff_t last = 0;
  for (int p = 0; p < count; ++p) {
    stencils.ahead.fetch(p);
    const std::ptrdiff_t place = place_in_pack<T>[p % Lanes<T>::width];
    if (p > 0 && place == 0) pack += groups * quad_group<T>, last += quad_group<T>;
    const T* const c = pack + place;
    const auto coefficient = [&](int group) { return repeated<T, K>(c + group * quad_group<T>); };
    const AxisWeights<K, T> x(stencils, 0, p, Gradient), y(stencils, D - 2, p, Gradient);
    const R w = weights.row(last + place);
    R plane = coefficient(0), step_x{}, step_y{}, slope_x{}, slope_y{};
    if constexpr (Affine) {
      plane = w * (plane + number * coefficient(D));
      step_x = w * coefficient(1);
      if constexpr (D == 3) step_y = w * coefficient(2);
    } else {
      plane = w * plane;
    }
    if constexpr (Gradient) {
      plane = plane + slopes.row(last + place) * coefficient(first_s + D - 1);
      slope_x = w * coefficient(first_s);
      if constexpr (D == 3) slope_y = w * coefficient(first_s + 1);
    }
    T* const first = tile + std::size_t(stencils.first[p]) * R::scalars;
    if (first != corner) {
      if (corner) rows.store(corner, line);
      rows.load(corner = first, line);
    }
#pragma GCC unroll 4
    for (int i = 0; i < K; ++i) {
      R row = times<T, K>(x.w[i], plane);
      if constexpr (Gradient) row = row + times<T, K>(x.g[i], slope_x);
      if constexpr (Affine) plane = plane + step_x;
      if constexpr (D == 2) {
        rows.set(i, rows.get(i, corner, line) + row, corner, line);
      } else {
        const R step = times<T, K>(x.w[i], step_y), slope = times<T, K>(x.w[i], slope_y);
#pragma GCC unroll 4
        for (int j = 0; j < K; ++j) {
          R value = rows.get(i * K + j, corner, line) + times<T, K>(y.w[j], row);
          if constexpr (Gradient) value = value + times<T, K>(y.g[j], slope);
          rows.set(i * K + j, value, corner, line);
          if constexpr (Affine) row = row + step;
        }
      }
    }
  }
  if (corner) rows.store(corner, line);
}

template <int D, class T, int K, bool Affine, bool Gradient>
void scatter_to_tile(T* tile, const Stencils<T>& stencils, const T* coefficients, int count) {
  if (stencils.shared) return scatter_particles<D, T, K, Affine, Gradient, true>(tile, stencils, coefficients, count);
  scatter_particles<D, T, K, Affine, Gradient, false>(tile, stencils, coefficients, count);
}

/// The sums over all rows of a stencil, into which its last axis' weights do not yet enter.
template <int K, class T>
struct StencilSums {
  Row<T, K> value{}, moment_x{}, moment_y{}, gradient_x{}, gradient_y{};
};

template <int D, class T, int K, bool Moment, bool Gradient, bool Shared>
MPM_ROW_INLINE StencilSums<K, T> sum_rows(const StencilRows<D, K, T, Shared, Gradient>& rows, const T* corner,
                                          const Stencils<T>& stencils, int p) {
  using R = Row<T, K>;
  constexpr int line = first_nodes_of_tile<D> * R::scalars;
  const AxisWeights<K, T> x(stencils, 0, p, Gradient), y(stencils, D - 2, p, Gradient);
  StencilSums<K, T> sums;
  typename R::Vector moment_y[K];
  for (int j = 2; D == 3 && Moment && j < K; ++j) moment_y[j] = broadcast<T, K>(T(j)) * y.w[j];
#pragma GCC unroll 4
  for (int i = 0; i < K; ++i) {
    R plane, plane_moment{}, plane_slope{};
    if constexpr (D == 2) {
      plane = rows.get(i, corner, line);
    } else {
#pragma GCC unroll 4
      for (int j = 0; j < K; ++j) {
        R row = rows.get(i * K + j, corner, line);
        if (Gradient || (Moment && j > 1)) stay_loaded(row);
        plane = j == 0 ? times<T, K>(y.w[j], row) : plane + times<T, K>(y.w[j], row);
        if constexpr (Moment) {
          if (j > 0) plane_moment = j == 1 ? times<T, K>(y.w[1], row) : plane_moment + times<T, K>(moment_y[j], row);
        }
        if constexpr (Gradient)
          plane_slope = j == 0 ? times<T, K>(y.g[j], row) : plane_slope + times<T, K>(y.g[j], row);
      }
    }
    const R term = times<T, K>(x.w[i], plane);
    sums.value = i == 0 ? term : sums.value + term;
    if constexpr (Moment) {
      if (i > 0) sums.moment_x = i == 1 ? term : sums.moment_x + times<T, K>(broadcast<T, K>(T(i)), term);
      if constexpr (D == 3)
        sums.moment_y = i == 0 ? times<T, K>(x.w[i], plane_moment) : sums.moment_y + times<T, K>(x.w[i], plane_moment);
    }
    if constexpr (Gradient) {
      sums.gradient_x = i == 0 ? times<T, K>(x.g[i], plane) : sums.gradient_x + times<T, K>(x.g[i], plane);
      if constexpr (D == 3)
        sums.gradient_y =
            i == 0 ? times<T, K>(x.w[i], plane_slope) : sums.gradient_y + times<T, K>(x.w[i], plane_slope);
    }
  }
  return sums;
}

/// Takes the sums over the rows of a pack's particles to its quads, for the four registers of a group one by one:
/// register i holds the particles i, i + 4, i + 8 ... (place_in_pack).
template <int D, class T, int K, bool Moment, bool Gradient>
struct PackSums {
  using R = Row<T, K>;
  static constexpr int width = Lanes<T>::width, blocks = width / 4;
  static constexpr int moments = Moment ? D - 1 : 0, gradients = Gradient ? D - 1 : 0, sums = 1 + moments + gradients;
  /// Whether the sums stay in registers, which have as many nodes as particles; one sum alone is faster through memory.
  static constexpr bool in_registers = K > 2 && sums > 1;

  static MPM_ROW_INLINE void list(const StencilSums<K, T>& from, R (&rows)[sums]) {
    rows[0] = from.value;
    if constexpr (Moment) rows[1] = from.moment_x;
    if constexpr (Moment && D == 3) rows[2] = from.moment_y;
    if constexpr (Gradient) rows[1 + moments] = from.gradient_x;
    if constexpr (Gradient && D == 3) rows[2 + moments] = from.gradient_y;
  }

  /// Sums over the nodes along the last axis, with its weights and slopes (lanes). node(sum, k) is node k of the
  /// particles.
  template <int i, class Node>
  static MPM_ROW_INLINE void store(T* quads, const T* weights, const T* slopes, Node&& node) {
    Lanes<T> w[K], terms[quad_groups(D, Moment, Gradient)];
    for (int k = 0; k < K; ++k) w[k] = of_block<i>(weights + k * chunk_size<T>);
    constexpr int first_g = 1 + (Moment ? D : 0);
    for (int k = 0; k < K; ++k) {
      const Lanes<T> value = node(0, k), term = w[k] * value;
      terms[0] = k == 0 ? term : terms[0] + term;
      if constexpr (Moment)
        if (k > 0) terms[D] = k == 1 ? term : terms[D] + T(k) * term;
      if constexpr (Gradient) {
        const Lanes<T> slope = of_block<i>(slopes + k * chunk_size<T>) * value;
        terms[first_g + D - 1] = k == 0 ? slope : terms[first_g + D - 1] + slope;
      }
    }
    const auto weighted = [&](int sum) {
      Lanes<T> total = w[0] * node(sum, 0);
      for (int k = 1; k < K; ++k) total = total + w[k] * node(sum, k);
      return total;
    };
    for (int a = 0; a < moments; ++a) terms[1 + a] = weighted(1 + a);
    for (int a = 0; a < gradients; ++a) terms[first_g + a] = weighted(1 + moments + a);
    for (int g = 0; g < quad_groups(D, Moment, Gradient); ++g) terms[g].store(quads + g * quad_group<T> + i * width);
  }

 private:
  /// Puts lane 4 k + i on all of block k.
  template <int i>
  static MPM_ROW_INLINE Lanes<T> of_block(const T* lanes) {
    const auto loaded = Lanes<T>::load(lanes).v;
    return Lanes<T>(pick<i, i, i, i, T>(loaded, loaded));
  }
};

/// Calls run.operator()<i>() for the registers of a group.
template <class Run>
MPM_ROW_INLINE void for_each_register(Run&& run) {
  run.template operator()<0>(), run.template operator()<1>(), run.template operator()<2>(),
      run.template operator()<3>();
}

/// Gathers one pack with its particles in order, where they share stencils, whose rows stay in registers. The sums pass
/// through memory.
template <int D, class T, int K, bool Moment, bool Gradient, bool Shared>
MPM_ROW_INLINE void gather_pack_in_order(StencilRows<D, K, T, Shared, Gradient>& rows, const T*& corner, const T* tile,
                                         const Stencils<T>& stencils, int first, T* quads, const T* weights,
                                         const T* slopes) {
  using Pack = PackSums<D, T, K, Moment, Gradient>;
  using R = Row<T, K>;
  alignas(64) T kept[Pack::sums][Pack::width * R::scalars];
  for (int lane = 0; lane < Pack::width; ++lane) {
    stencils.ahead.fetch(first + lane);
    const T* const place = tile + std::size_t(stencils.first[first + lane]) * R::scalars;
    if (place != corner) rows.load(corner = place, first_nodes_of_tile<D> * R::scalars);
    R sums[Pack::sums];
    Pack::list(sum_rows<D, T, K, Moment, Gradient, Shared>(rows, corner, stencils, first + lane), sums);
    for (int s = 0; s < Pack::sums; ++s) store_row(kept[s] + lane * R::scalars, sums[s]);
  }
  for_each_register([&]<int i> {
    Pack::template store<i>(quads, weights, slopes, [&](int sum, int k) {
      return Lanes<T>(join_quads<T>(kept[sum] + i * R::scalars + 4 * k, 4 * R::scalars));
    });
  });
}

/// Gathers one pack register by register: the sums never leave the registers.
template <int D, class T, int K, bool Moment, bool Gradient>
MPM_ROW_INLINE void gather_pack_by_register(const T* tile, const Stencils<T>& stencils, int first, T* quads,
                                            const T* weights, const T* slopes) {
  using Pack = PackSums<D, T, K, Moment, Gradient>;
  using R = Row<T, K>;
  const StencilRows<D, K, T, false, Gradient> rows{};  // it keeps none
  for_each_register([&]<int i> {
    R sums[Pack::blocks][Pack::sums];
#pragma GCC unroll 4
    for (int k = 0; k < Pack::blocks; ++k) {
      const int p = first + i + 4 * k;
      stencils.ahead.fetch(p);
      const T* const corner = tile + std::size_t(stencils.first[p]) * R::scalars;
      Pack::list(sum_rows<D, T, K, Moment, Gradient, false>(rows, corner, stencils, p), sums[k]);
    }
    Lanes<T> nodes[Pack::sums][4];
    for (int s = 0; s < Pack::sums; ++s) {
      R of_sum[Pack::blocks];
      for (int k = 0; k < Pack::blocks; ++k) of_sum[k] = sums[k][s];
      nodes_of_rows<T, K>(of_sum, nodes[s]);
    }
    Pack::template store<i>(quads, weights, slopes, [&](int sum, int k) { return nodes[sum][k]; });
  });
}

template <int D, class T, int K, bool Moment, bool Gradient, bool Shared>
void gather_particles(const T* tile, const Stencils<T>& stencils, T* moments, int count) {
  constexpr int width = Lanes<T>::width, last = (D - 1) * K * chunk_size<T>;
  [[maybe_unused]] StencilRows<D, K, T, Shared, Gradient> rows;
  [[maybe_unused]] const T* corner = nullptr;
  for (int first = 0; first < count; first += width) {
    T* const quads = moments + quad_place<T>(first, quad_groups(D, Moment, Gradient));
    const T *const weights = stencils.weight + last + first, *const slopes = stencils.gradient + last + first;
    if constexpr (!Shared && PackSums<D, T, K, Moment, Gradient>::in_registers)
      gather_pack_by_register<D, T, K, Moment, Gradient>(tile, stencils, first, quads, weights, slopes);
    else
      gather_pack_in_order<D, T, K, Moment, Gradient, Shared>(rows, corner, tile, stencils, first, quads, weights,
                                                              slopes);
  }
}

template <int D, class T, int K, bool Moment, bool Gradient>
void gather_from_tile(const T* tile, const Stencils<T>& stencils, T* moments, int count) {
  if (stencils.shared) return gather_particles<D, T, K, Moment, Gradient, true>(tile, stencils, moments, count);
  gather_particles<D, T, K, Moment, Gradient, false>(tile, stencils, moments, count);
}

}  // namespace mpm::cpu
