#pragma once
// Four scalars of one node or particle as one register, and the transposes between arrays of components and of quads.

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

template <class T>
inline void transpose(Quad<T>& a, Quad<T>& b, Quad<T>& c, Quad<T>& d) {
  const Quad<T> ab_low = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab_high = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad<T> cd_low = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd_high = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  b = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

/// Component arrays -> one quad a particle, `groups` quads apart. A null component is zero. `count` a multiple of 4.
template <class T>
inline void pack_quads(T* quads, int groups, const T* x, const T* y, const T* z, const T* w, int count) {
  using Q = Quad<T>;
  Q* out = reinterpret_cast<Q*>(quads);
  const auto load = [](const T* component, int p) {
    return component ? *reinterpret_cast<const Q*>(component + p) : Q{};
  };
  for (int p = 0; p < count; p += 4) {
    Q a = load(x, p), b = load(y, p), c = load(z, p), d = load(w, p);
    transpose<T>(a, b, c, d);
    out[(p + 0) * groups] = a;
    out[(p + 1) * groups] = b;
    out[(p + 2) * groups] = c;
    out[(p + 3) * groups] = d;
  }
}

/// One quad a particle -> the first D component arrays.
template <int D, class T>
inline void unpack_quads(const T* quads, int groups, T* const (&out)[3], int count) {
  using Q = Quad<T>;
  const Q* in = reinterpret_cast<const Q*>(quads);
  for (int p = 0; p < count; p += 4) {
    Q a = in[p * groups], b = in[(p + 1) * groups], c = in[(p + 2) * groups], d = in[(p + 3) * groups];
    transpose<T>(a, b, c, d);
    *reinterpret_cast<Q*>(out[0] + p) = a;
    *reinterpret_cast<Q*>(out[1] + p) = b;
    if constexpr (D == 3) *reinterpret_cast<Q*>(out[2] + p) = c;
  }
}

}  // namespace mpm::cpu
