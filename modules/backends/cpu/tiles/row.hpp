#pragma once
// A row is the nodes of one stencil row as vector registers: 2 (K = 2) or 4 quads side by side. A stencil of 3 nodes
// leaves the fourth quad of its row unused: scatter gives it weight zero, gather masks it.

#include "backends/cpu/tiles/quad.hpp"
#include "kernel/lanes.hpp"

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace mpm::cpu {

#if defined(__AVX512F__)
inline constexpr int vector_registers = 32;
#else
inline constexpr int vector_registers = 16;
#endif

template <class T, int K>
struct Row {
  static constexpr int nodes = K == 2 ? 2 : 4, scalars = nodes * 4;
  static constexpr int row_bytes = scalars * static_cast<int>(sizeof(T));
  static constexpr int vector_bytes = row_bytes < lane_bytes ? row_bytes : lane_bytes;
  static constexpr int vectors = row_bytes / vector_bytes;  ///< registers a row
  static constexpr int width = scalars / vectors;           ///< scalars a register
  static constexpr int nodes_a_vector = nodes / vectors;    ///< 1, 2 or 4
  typedef T Vector __attribute__((vector_size(vector_bytes)));
  typedef typename Lanes<T>::integer Index __attribute__((vector_size(vector_bytes)));
  typedef T Unaligned __attribute__((vector_size(vector_bytes), aligned(sizeof(T)), may_alias));

  Vector v[vectors];
};

#define MPM_ROW_INLINE inline __attribute__((always_inline))

/// Puts one scalar on all of a register.
template <class T, int K>
MPM_ROW_INLINE typename Row<T, K>::Vector broadcast(T x) {
  return x - typename Row<T, K>::Vector{};
}
template <class T, int K>
MPM_ROW_INLINE Row<T, K> load_row(const T* p) {
  using R = Row<T, K>;
  R row;
  for (int i = 0; i < R::vectors; ++i) row.v[i] = *reinterpret_cast<const typename R::Unaligned*>(p + i * R::width);
  return row;
}
/// Keeps a row loaded: the compiler would load one that is used twice two times, and most loads cross a cache line.
template <class T, int K>
MPM_ROW_INLINE void stay_loaded([[maybe_unused]] Row<T, K>& row) {
#if defined(__AVX512F__)
  for (int i = 0; i < Row<T, K>::vectors; ++i) asm("" : "+v"(row.v[i]));
#endif
}
template <class T, int K>
MPM_ROW_INLINE void store_row(T* p, const Row<T, K>& row) {
  using R = Row<T, K>;
  for (int i = 0; i < R::vectors; ++i) *reinterpret_cast<typename R::Unaligned*>(p + i * R::width) = row.v[i];
}
template <class T, int K>
MPM_ROW_INLINE Row<T, K> operator+(Row<T, K> a, const Row<T, K>& b) {
  for (int i = 0; i < Row<T, K>::vectors; ++i) a.v[i] += b.v[i];
  return a;
}
template <class T, int K>
MPM_ROW_INLINE Row<T, K> operator*(Row<T, K> a, const Row<T, K>& b) {
  for (int i = 0; i < Row<T, K>::vectors; ++i) a.v[i] *= b.v[i];
  return a;
}
template <class T, int K>
MPM_ROW_INLINE Row<T, K> times(typename Row<T, K>::Vector a, Row<T, K> b) {
  for (int i = 0; i < Row<T, K>::vectors; ++i) b.v[i] *= a;
  return b;
}

/// Puts the same quad at every node.
template <class T, int K>
MPM_ROW_INLINE Row<T, K> repeated(const T* quad) {
  using R = Row<T, K>;
  R row;
  typename R::Vector& first = row.v[0];
#if defined(__AVX512F__)
  if constexpr (R::vector_bytes == 64 && sizeof(T) == 4) {
    first = (typename R::Vector)_mm512_broadcast_f32x4(_mm_load_ps(quad));
  } else if constexpr (R::vector_bytes == 64) {
    first = (typename R::Vector)_mm512_broadcast_f64x4(_mm256_load_pd(quad));
  } else
#endif
  {
    const Quad<T> q = *reinterpret_cast<const Quad<T>*>(quad);
    if constexpr (R::nodes_a_vector == 1)
      first = (typename R::Vector)q;
    else  // two nodes; the case of four is above
      first = (typename R::Vector)__builtin_shufflevector(q, q, 0, 1, 2, 3, 0, 1, 2, 3);
  }
  for (int i = 1; i < R::vectors; ++i) row.v[i] = first;
  return row;
}

/// Loads a quad into the first lanes of a register, anything into the others. No more than the quad is loaded: it was
/// stored just so, and a longer load would wait for that store.
template <class T, int K>
MPM_ROW_INLINE typename Row<T, K>::Vector load_quad(const T* quad) {
  using R = Row<T, K>;
  using Vector = typename R::Vector;
  const Quad<T> q = *reinterpret_cast<const Quad<T>*>(quad);
#if defined(__AVX512F__)
  if constexpr (R::vector_bytes == 64 && sizeof(T) == 4) return (Vector)_mm512_castps128_ps512((__m128)q);
  if constexpr (R::vector_bytes == 64 && sizeof(T) == 8) return (Vector)_mm512_castpd256_pd512((__m256d)q);
#endif
  if constexpr (R::nodes_a_vector == 1) return (Vector)q;
  if constexpr (R::nodes_a_vector == 2)
    return (Vector)__builtin_shufflevector(q, q, 0, 1, 2, 3, 0, 1, 2, 3);
  else
    return Vector{};
}

/// Puts scalar k of a quad on all of node k.
template <class T, int K>
MPM_ROW_INLINE Row<T, K> spread(const T* quad) {
  using R = Row<T, K>;
  const typename R::Vector loaded = load_quad<T, K>(quad);
  R row;
  const auto all = std::make_index_sequence<R::width>();
  const auto part = [&]<int i>(std::integral_constant<int, i>) {
    if constexpr (i < R::vectors)
      row.v[i] = shuffled<[](int lane) { return i * R::nodes_a_vector + lane / 4; }>(loaded, loaded, all);
  };
  part(std::integral_constant<int, 0>());
  part(std::integral_constant<int, 1>());
  part(std::integral_constant<int, 2>());
  part(std::integral_constant<int, 3>());
  return row;
}

/// Puts the number of a node within the row on all of it.
template <class T, int K>
MPM_ROW_INLINE Row<T, K> node_numbers() {
  using R = Row<T, K>;
  R row;
  for (int i = 0; i < R::vectors; ++i)
    for (int lane = 0; lane < R::width; ++lane) {
      const int node = i * R::nodes_a_vector + lane / 4;
      row.v[i][lane] = static_cast<T>(node);
    }
  return row;
}

/// Puts node k of as many rows as a register has nodes side by side in their order, for k < 4: a transpose of quads.
template <class T, int K>
MPM_ROW_INLINE void nodes_of_rows(const Row<T, K> (&rows)[Row<T, K>::nodes_a_vector], Lanes<T> (&nodes)[4]) {
  using R = Row<T, K>;
  using V = typename R::Vector;
  constexpr auto all = std::make_index_sequence<R::width>();
  if constexpr (R::nodes_a_vector == 1) {
    for (int k = 0; k < 4; ++k) nodes[k].v = rows[0].v[k];
  } else if constexpr (R::nodes_a_vector == 2) {
    for (int k = 0; k < 4; ++k) {
      const V a = rows[0].v[k / 2], b = rows[1].v[k / 2];
      constexpr int half = R::width / 2;
      nodes[k].v = k % 2 == 0
                       ? shuffled<[](int lane) { return lane < half ? lane : R::width + lane - half; }>(a, b, all)
                       : shuffled<[](int lane) { return lane < half ? lane + half : R::width + lane; }>(a, b, all);
    }
  } else {
    constexpr auto halves = [](auto low) {
      return [](int lane) { return (lane < 8 ? lane : lane + 8) + (decltype(low)::value ? 0 : 8); };
    };
    constexpr auto quads = [](auto even) {
      return [](int lane) { return lane / 4 * 8 + lane % 4 + (decltype(even)::value ? 0 : 4); };
    };
    const V ab = shuffled<halves(std::true_type())>(rows[0].v[0], rows[1].v[0], all);
    const V cd = shuffled<halves(std::true_type())>(rows[2].v[0], rows[3].v[0], all);
    const V AB = shuffled<halves(std::false_type())>(rows[0].v[0], rows[1].v[0], all);
    const V CD = shuffled<halves(std::false_type())>(rows[2].v[0], rows[3].v[0], all);
    nodes[0].v = shuffled<quads(std::true_type())>(ab, cd, all);
    nodes[1].v = shuffled<quads(std::false_type())>(ab, cd, all);
    nodes[2].v = shuffled<quads(std::true_type())>(AB, CD, all);
    nodes[3].v = shuffled<quads(std::false_type())>(AB, CD, all);
  }
}

}  // namespace mpm::cpu
