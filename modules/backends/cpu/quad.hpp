#pragma once
// Four scalars of one node or particle as one register, and the transposes between arrays of components and of quads.

#include <cstddef>

#include "kernel/lanes.hpp"

namespace mpm::cpu {

template <class T>
struct QuadOf;
template <>
struct QuadOf<float> {
  typedef float Vector __attribute__((vector_size(16), may_alias));
};
template <>
struct QuadOf<double> {
  typedef double Vector __attribute__((vector_size(32), may_alias));
};
template <class T>
using Quad = typename QuadOf<T>::Vector;

/// Block k of four lanes holds the quad of particle 4 k + i.
template <class T>
using QuadLanes = typename Lanes<T>::Vector;

template <class T>
inline __attribute__((always_inline)) QuadLanes<T> join_quads(const T* first, std::size_t step) {
  constexpr int blocks = Lanes<T>::width / 4;
#if defined(__AVX512F__)  // the compiler would load each quad before it joins them
  if constexpr (blocks == 4) {
    __m512 joined = _mm512_castps128_ps512(_mm_load_ps(first));
    joined = _mm512_insertf32x4(joined, _mm_load_ps(first + step), 1);
    joined = _mm512_insertf32x4(joined, _mm_load_ps(first + 2 * step), 2);
    return (QuadLanes<T>)_mm512_insertf32x4(joined, _mm_load_ps(first + 3 * step), 3);
  } else {
    const __m512d joined = _mm512_castpd256_pd512(_mm256_load_pd(first));
    return (QuadLanes<T>)_mm512_insertf64x4(joined, _mm256_load_pd(first + step), 1);
  }
#else
  const auto quad = [&](int k) { return *reinterpret_cast<const Quad<T>*>(first + k * step); };
  if constexpr (blocks == 1)
    return (QuadLanes<T>)quad(0);
  else
    return __builtin_shufflevector(quad(0), quad(1), 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}
template <class T>
inline __attribute__((always_inline)) void part_quads(QuadLanes<T> lanes, T* first, std::size_t step) {
  constexpr int blocks = Lanes<T>::width / 4;
#if defined(__AVX512F__)
  if constexpr (blocks == 4) {
    const __m512 joined = (__m512)lanes;
    _mm_store_ps(first, _mm512_castps512_ps128(joined));
    _mm_store_ps(first + step, _mm512_extractf32x4_ps(joined, 1));
    _mm_store_ps(first + 2 * step, _mm512_extractf32x4_ps(joined, 2));
    _mm_store_ps(first + 3 * step, _mm512_extractf32x4_ps(joined, 3));
  } else {
    _mm256_store_pd(first, _mm512_castpd512_pd256((__m512d)lanes));
    _mm256_store_pd(first + step, _mm512_extractf64x4_pd((__m512d)lanes, 1));
  }
#else
  Quad<T>* const low = reinterpret_cast<Quad<T>*>(first);
  if constexpr (blocks == 1) {
    *low = (Quad<T>)lanes;
  } else {
    *low = (Quad<T>)__builtin_shufflevector(lanes, lanes, 0, 1, 2, 3);
    *reinterpret_cast<Quad<T>*>(first + step) = (Quad<T>)__builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
  }
#endif
}

/// Lanes p0 p1 p2 p3 of each block of four, out of a (0 to 3) or b (4 to 7).
template <int p0, int p1, int p2, int p3, class T>
inline __attribute__((always_inline)) QuadLanes<T> pick(QuadLanes<T> a, QuadLanes<T> b) {
  constexpr auto source = [](int lane) {
    const int from[4] = {p0, p1, p2, p3}, place = lane / 4 * 4 + from[lane % 4] % 4;
    return from[lane % 4] < 4 ? place : Lanes<T>::width + place;
  };
  return shuffled<source>(a, b, std::make_index_sequence<Lanes<T>::width>());
}

/// Quads of a pack of particles <-> their components: the transpose of every block of 4 x 4.
template <class T>
inline __attribute__((always_inline)) void transpose_blocks(QuadLanes<T> (&q)[4]) {
  if constexpr (sizeof(T) == 4) {  // within registers of 128 bits
    const QuadLanes<T> ab = pick<0, 4, 1, 5, T>(q[0], q[1]), AB = pick<2, 6, 3, 7, T>(q[0], q[1]);
    const QuadLanes<T> cd = pick<0, 4, 1, 5, T>(q[2], q[3]), CD = pick<2, 6, 3, 7, T>(q[2], q[3]);
    q[0] = pick<0, 1, 4, 5, T>(ab, cd), q[1] = pick<2, 3, 6, 7, T>(ab, cd);
    q[2] = pick<0, 1, 4, 5, T>(AB, CD), q[3] = pick<2, 3, 6, 7, T>(AB, CD);
  } else {
    const QuadLanes<T> ab = pick<0, 4, 2, 6, T>(q[0], q[1]), AB = pick<1, 5, 3, 7, T>(q[0], q[1]);
    const QuadLanes<T> cd = pick<0, 4, 2, 6, T>(q[2], q[3]), CD = pick<1, 5, 3, 7, T>(q[2], q[3]);
    q[0] = pick<0, 1, 4, 5, T>(ab, cd), q[2] = pick<2, 3, 6, 7, T>(ab, cd);
    q[1] = pick<0, 1, 4, 5, T>(AB, CD), q[3] = pick<2, 3, 6, 7, T>(AB, CD);
  }
}
template <class T>
inline __attribute__((always_inline)) void load_quads(const T* quads, std::size_t step, Lanes<T> (&component)[4]) {
  QuadLanes<T> q[4];
  for (int i = 0; i < 4; ++i) q[i] = join_quads<T>(quads + i * step, 4 * step);
  transpose_blocks<T>(q);
  for (int i = 0; i < 4; ++i) component[i].v = q[i];
}
template <class T>
inline __attribute__((always_inline)) void store_quads(T* quads, std::size_t step, const Lanes<T> (&component)[4]) {
  QuadLanes<T> q[4];
  for (int i = 0; i < 4; ++i) q[i] = component[i].v;
  transpose_blocks<T>(q);
  for (int i = 0; i < 4; ++i) part_quads<T>(q[i], quads + i * step, 4 * step);
}

#if defined(__AVX512F__)
/// Four quads a particle, one after another: whole registers are stored, which takes fewer shuffles than parting each.
inline __attribute__((always_inline)) void store_four_groups(float* quads, const QuadLanes<float> (&q)[4][4]) {
  for (int i = 0; i < 4; ++i) {  // the transpose of blocks of 128 bits: group of quads by particle
    const __m512 a = (__m512)q[0][i], b = (__m512)q[1][i], c = (__m512)q[2][i], d = (__m512)q[3][i];
    const __m512 ab_low = _mm512_shuffle_f32x4(a, b, 0x44), ab_high = _mm512_shuffle_f32x4(a, b, 0xee);
    const __m512 cd_low = _mm512_shuffle_f32x4(c, d, 0x44), cd_high = _mm512_shuffle_f32x4(c, d, 0xee);
    _mm512_store_ps(quads + 16 * i, _mm512_shuffle_f32x4(ab_low, cd_low, 0x88));
    _mm512_store_ps(quads + 16 * (i + 4), _mm512_shuffle_f32x4(ab_low, cd_low, 0xdd));
    _mm512_store_ps(quads + 16 * (i + 8), _mm512_shuffle_f32x4(ab_high, cd_high, 0x88));
    _mm512_store_ps(quads + 16 * (i + 12), _mm512_shuffle_f32x4(ab_high, cd_high, 0xdd));
  }
}
#endif
/// `groups` quads a particle, one after another.
template <class T, int groups>
inline __attribute__((always_inline)) void store_groups(T* quads, const Lanes<T> (&component)[groups][4]) {
#if defined(__AVX512F__)
  if constexpr (groups == 4 && sizeof(T) == 4) {
    QuadLanes<T> q[4][4];
    for (int g = 0; g < 4; ++g) {
      for (int i = 0; i < 4; ++i) q[g][i] = component[g][i].v;
      transpose_blocks<T>(q[g]);
    }
    return store_four_groups(quads, q);
  }
#endif
  for (int g = 0; g < groups; ++g) store_quads<T>(quads + 4 * g, 4 * groups, component[g]);
}

}  // namespace mpm::cpu
