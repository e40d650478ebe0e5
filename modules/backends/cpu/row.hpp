#pragma once
// The nodes of one stencil row as vector registers: 2 (K = 2) or 4 quads side by side. A stencil of 3 nodes leaves the
// fourth quad of its row unused: scatter gives it weight zero, gather masks it.

#include "kernel/lanes.hpp"
#include "quad.hpp"

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

/// One scalar on all of a register.
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

/// The same quad at every node.
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
    else if constexpr (R::nodes_a_vector == 2)
      first = (typename R::Vector)__builtin_shufflevector(q, q, 0, 1, 2, 3, 0, 1, 2, 3);
    else
      first = (typename R::Vector)__builtin_shufflevector(q, q, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
  }
  for (int i = 1; i < R::vectors; ++i) row.v[i] = first;
  return row;
}

/// A quad in the first lanes of a register, anything in the others. No more than the quad is loaded: it was stored just
/// so, and a longer load would wait for that store.
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

/// Scalar k of a quad on all of node k.
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

/// Number of a node within the row, on all of it.
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

}  // namespace mpm::cpu
