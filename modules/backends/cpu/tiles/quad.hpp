#pragma once
// A quad is four scalars of one node or particle as one register; transposes turn arrays of components into quads.

#include <array>
#include <cstddef>
#include <cstdint>

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

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

/// A register of quads, whose block k of four lanes holds the quad of particle 4 k + i.
template <class T>
using QuadLanes = typename Lanes<T>::Vector;

/// Joins quads that lie `step` scalars from one another into one register.
template <class T>
inline __attribute__((always_inline)) QuadLanes<T> join_quads(const T* first, std::size_t step) {
  constexpr int blocks = Lanes<T>::width / 4;
#if defined(__AVX512F__)                           // the compiler would load each quad before it joins them
  constexpr auto all = static_cast<__mmask8>(-1);  // without a mask GCC 12 warns of its own header
  if constexpr (blocks == 4) {
    __m512 joined = _mm512_castps128_ps512(_mm_load_ps(first));
    joined = _mm512_maskz_insertf32x4(static_cast<__mmask16>(-1), joined, _mm_load_ps(first + step), 1);
    joined = _mm512_maskz_insertf32x4(static_cast<__mmask16>(-1), joined, _mm_load_ps(first + 2 * step), 2);
    return (QuadLanes<T>)_mm512_maskz_insertf32x4(static_cast<__mmask16>(-1), joined, _mm_load_ps(first + 3 * step), 3);
  } else {
    const __m512d joined = _mm512_castpd256_pd512(_mm256_load_pd(first));
    return (QuadLanes<T>)_mm512_maskz_insertf64x4(all, joined, _mm256_load_pd(first + step), 1);
  }
#else
  const auto quad = [&](int k) { return *reinterpret_cast<const Quad<T>*>(first + k * step); };
  if constexpr (blocks == 1)
    return (QuadLanes<T>)quad(0);
  else
    return __builtin_shufflevector(quad(0), quad(1), 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}
/// Takes lanes p0 p1 p2 p3 of each block of four, out of a (0 to 3) or b (4 to 7).
template <int p0, int p1, int p2, int p3, class T>
inline __attribute__((always_inline)) QuadLanes<T> pick(QuadLanes<T> a, QuadLanes<T> b) {
  constexpr auto source = [](int lane) {
    const int from[4] = {p0, p1, p2, p3}, place = lane / 4 * 4 + from[lane % 4] % 4;
    return from[lane % 4] < 4 ? place : Lanes<T>::width + place;
  };
  return shuffled<source>(a, b, std::make_index_sequence<Lanes<T>::width>());
}

/// Turns quads of a pack of particles into components, or back, by transposing every block of 4 x 4.
template <class T>
inline __attribute__((always_inline)) void transpose_blocks(QuadLanes<T> (&q)[4]) {
  if constexpr (sizeof(T) == 4) {  // shuffles stay within registers of 128 bits
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
/// The place of a particle's quad among those of its pack, as the registers of a transpose have them: particle 4 k + i
/// is in block k of register i.
template <class T>
inline constexpr auto place_in_pack = [] {
  constexpr int width = Lanes<T>::width;
  std::array<std::ptrdiff_t, width> place{};
  for (int lane = 0; lane < width; ++lane) place[lane] = lane % 4 * width + lane / 4 * 4;
  return place;
}();
/// The place of a particle's first quad; those of a chunk lie pack by pack, group by group in a pack.
template <class T>
inline __attribute__((always_inline)) std::size_t quad_place(int particle, int groups) {
  constexpr int width = Lanes<T>::width;
  return static_cast<std::size_t>(particle / width * groups * 4 * width + place_in_pack<T>[particle % width]);
}
/// The number of scalars from one group of a pack's quads to the next.
template <class T>
inline constexpr int quad_group = 4 * Lanes<T>::width;

/// These turn one group of a pack's quads into its components, and back.
template <class T>
inline __attribute__((always_inline)) void load_quads(const T* group, Lanes<T> (&component)[4]) {
  QuadLanes<T> q[4];
  for (int i = 0; i < 4; ++i) q[i] = Lanes<T>::load(group + i * Lanes<T>::width).v;
  transpose_blocks<T>(q);
  for (int i = 0; i < 4; ++i) component[i].v = q[i];
}
template <class T>
inline __attribute__((always_inline)) void store_quads(T* group, const Lanes<T> (&component)[4]) {
  QuadLanes<T> q[4];
  for (int i = 0; i < 4; ++i) q[i] = component[i].v;
  transpose_blocks<T>(q);
  for (int i = 0; i < 4; ++i) Lanes<T>(q[i]).store(group + i * Lanes<T>::width);
}

}  // namespace mpm::cpu
