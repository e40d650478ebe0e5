#pragma once
// A pack of lanes: one functor source computes several particles at once. Built on the compiler's vector extension,
// which lowers to whatever the target has (AVX-512, AVX2, SSE2, or scalars). Host only; the device pass never sees it.

#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "kernel/math.hpp"

namespace mpm {

#if defined(__AVX512F__)
inline constexpr int lane_bytes = 64;
#else
inline constexpr int lane_bytes = 32;
#endif

template <class T>
struct LaneTypes;
template <>
struct LaneTypes<float> {
  typedef float Vector __attribute__((vector_size(lane_bytes)));
  typedef std::int32_t Mask __attribute__((vector_size(lane_bytes)));
  typedef std::uint32_t Bits __attribute__((vector_size(lane_bytes)));
  using Integer = std::int32_t;
};
template <>
struct LaneTypes<double> {
  typedef double Vector __attribute__((vector_size(lane_bytes)));
  typedef std::int64_t Mask __attribute__((vector_size(lane_bytes)));
  typedef std::uint64_t Bits __attribute__((vector_size(lane_bytes)));
  using Integer = std::int64_t;
};

template <class T>
struct Lanes {
  static constexpr int width = lane_bytes / static_cast<int>(sizeof(T));
  using integer = typename LaneTypes<T>::Integer;
  using Vector = typename LaneTypes<T>::Vector;
  using Mask = typename LaneTypes<T>::Mask;
  using Bits = typename LaneTypes<T>::Bits;  ///< unsigned: wraps where a mask would overflow

  Vector v;

  Lanes() = default;
  MPM_HD Lanes(Vector x) : v(x) {}
  MPM_HD Lanes(T x) : v(x - Vector{}) {}

  MPM_HD static Lanes load(const T* p) {
    return Lanes(*reinterpret_cast<const Vector*>(p));  // a vector aliases its scalars, nothing else
  }
  MPM_HD void store(T* p) const { *reinterpret_cast<Vector*>(p) = v; }

  MPM_HD friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
  MPM_HD friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
  MPM_HD friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
  MPM_HD friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
  MPM_HD friend Lanes operator+(Lanes a, T b) { return Lanes(a.v + b); }
  MPM_HD friend Lanes operator-(Lanes a, T b) { return Lanes(a.v - b); }
  MPM_HD friend Lanes operator*(Lanes a, T b) { return Lanes(a.v * b); }
  MPM_HD friend Lanes operator/(Lanes a, T b) { return Lanes(a.v / b); }
  MPM_HD friend Lanes operator+(T a, Lanes b) { return Lanes(a + b.v); }
  MPM_HD friend Lanes operator-(T a, Lanes b) { return Lanes(a - b.v); }
  MPM_HD friend Lanes operator*(T a, Lanes b) { return Lanes(a * b.v); }
  MPM_HD friend Lanes operator/(T a, Lanes b) { return Lanes(a / b.v); }
  MPM_HD friend Lanes operator-(Lanes a) { return Lanes(-a.v); }
  MPM_HD friend Mask operator<(Lanes a, Lanes b) { return a.v < b.v; }
  MPM_HD friend Mask operator>(Lanes a, Lanes b) { return a.v > b.v; }
  MPM_HD friend Mask operator<=(Lanes a, Lanes b) { return a.v <= b.v; }
  MPM_HD friend Mask operator>=(Lanes a, Lanes b) { return a.v >= b.v; }
  MPM_HD friend Mask operator<(Lanes a, T b) { return a.v < b; }
  MPM_HD friend Mask operator>(Lanes a, T b) { return a.v > b; }
  MPM_HD friend Mask operator<=(Lanes a, T b) { return a.v <= b; }
  MPM_HD friend Mask operator>=(Lanes a, T b) { return a.v >= b; }
  MPM_HD T operator[](int i) const { return v[i]; }

  MPM_HD friend Lanes select(Mask m, Lanes a, Lanes b) { return Lanes(m ? a.v : b.v); }
  MPM_HD friend Lanes min(Lanes a, Lanes b) { return Lanes(a.v < b.v ? a.v : b.v); }
  MPM_HD friend Lanes max(Lanes a, Lanes b) { return Lanes(a.v > b.v ? a.v : b.v); }
  MPM_HD friend Lanes abs(Lanes a) { return Lanes(a.v < T(0) ? -a.v : a.v); }
  MPM_HD friend Lanes sqrt(Lanes a) {
    for (int i = 0; i < width; ++i) a.v[i] = std::sqrt(a.v[i]);
    return a;
  }
  MPM_HD friend Lanes floor(Lanes a) {
    for (int i = 0; i < width; ++i) a.v[i] = std::floor(a.v[i]);
    return a;
  }

  /// Natural logarithm to about 1 ulp; NaN below zero, -inf at zero. Exponent split, then the atanh series of the
  /// mantissa.
  MPM_HD friend Lanes log(Lanes x) {
    using unsigned_integer = std::make_unsigned_t<integer>;
    constexpr unsigned_integer one_over_sqrt2 =
        sizeof(T) == 4 ? unsigned_integer(0x3f3504f3) : unsigned_integer(0x3fe6a09e667f3bcdULL);
    constexpr int mantissa_bits = sizeof(T) == 4 ? 23 : 52;
    Bits bits;
    std::memcpy(&bits, &x.v, sizeof bits);
    const Mask exponent = (Mask)(bits - one_over_sqrt2) >> mantissa_bits;
    bits -= (Bits)exponent << mantissa_bits;
    Vector m;
    std::memcpy(&m, &bits, sizeof m);
    const Vector e = __builtin_convertvector(exponent, Vector);
    const Vector s = (m - T(1)) / (m + T(1)), z = s * s;
    constexpr int last = sizeof(T) == 4 ? 9 : 23;
    Vector p = T(1.0 / last) - Vector{};
    for (int k = last - 2; k >= 3; k -= 2) p = p * z + T(1.0 / k);
    constexpr T ln2_high = sizeof(T) == 4 ? T(0.693145751953125) : T(0.693147180369123816490);
    constexpr T ln2_low = sizeof(T) == 4 ? T(1.428606765330187e-6) : T(1.90821492927058770002e-10);
    Vector r = e * ln2_high + (T(2) * s + (T(2) * s * z * p + e * ln2_low));
    constexpr T infinity = std::numeric_limits<T>::infinity();
    r = x.v >= std::numeric_limits<T>::min()
            ? r
            : (x.v >= T(0) ? -infinity - Vector{} : std::numeric_limits<T>::quiet_NaN() - Vector{});
    return Lanes(x.v < infinity ? r : x.v + r);
  }

  /// Exponential to about 1 ulp; saturates to 0 and infinity.
  MPM_HD friend Lanes exp(Lanes x) {
    constexpr T limit = sizeof(T) == 4 ? T(87.0) : T(708.0);
    const Vector clamped = x.v > limit ? limit - Vector{} : (x.v < -limit ? -limit - Vector{} : x.v);
    const Lanes n = floor(Lanes(clamped * T(1.4426950408889634) + T(0.5)));
    constexpr T ln2_high = sizeof(T) == 4 ? T(0.693145751953125) : T(0.693147180369123816490);
    constexpr T ln2_low = sizeof(T) == 4 ? T(1.428606765330187e-6) : T(1.90821492927058770002e-10);
    const Vector r = (clamped - n.v * ln2_high) - n.v * ln2_low;
    constexpr int terms = sizeof(T) == 4 ? 7 : 13;
    Vector p = T(1) - Vector{};
    for (int k = terms; k >= 1; --k) p = p * r * T(1.0 / k) + T(1);
    constexpr int mantissa_bits = sizeof(T) == 4 ? 23 : 52;
    constexpr integer bias = sizeof(T) == 4 ? 127 : 1023;
    Mask bits = (__builtin_convertvector(n.v, Mask) + bias) << mantissa_bits;
    Vector scale;
    std::memcpy(&scale, &bits, sizeof scale);
    Vector result = p * scale;
    result = x.v > limit ? std::numeric_limits<T>::infinity() - Vector{} : result;
    result = x.v < -limit ? Vector{} : result;
    return Lanes(x.v == x.v ? result : x.v);
  }
};

/// Lane i of the result is lane source(i) of a, or of b beyond a's last.
template <auto source, class Vector, std::size_t... lane>
inline __attribute__((always_inline)) Vector shuffled(Vector a, Vector b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, source(static_cast<int>(lane))...);
}

/// Whether any lane of a comparison holds.
template <class T>
inline bool any_lane(typename Lanes<T>::Mask mask) {
// These are the compilers' own names for one instruction: <immintrin.h> takes longer to read than a plugin.
#if defined(__AVX512F__) && __has_builtin(__builtin_ia32_ptestmd512)
  typedef int Words __attribute__((vector_size(64)));
  return __builtin_ia32_ptestmd512((Words)mask, (Words)mask, 0xffff) != 0;
#elif defined(__AVX512F__) && __has_builtin(__builtin_ia32_cmpd512_mask)
  typedef int Words __attribute__((vector_size(64)));
  return __builtin_ia32_cmpd512_mask((Words)mask, Words{}, 4, 0xffff) != 0;
#elif defined(__AVX2__) && !defined(__AVX512F__) && __has_builtin(__builtin_ia32_ptestz256)
  typedef long long Words __attribute__((vector_size(32)));
  return __builtin_ia32_ptestz256((Words)mask, (Words)mask) == 0;
#else
  return any(mask);
#endif
}

template <class T>
inline T largest_lane(Lanes<T> lanes) {
  constexpr auto all = std::make_index_sequence<Lanes<T>::width>();
  const auto with = [&](auto partner) { lanes = max(lanes, Lanes<T>(shuffled<partner>(lanes.v, lanes.v, all))); };
  if constexpr (Lanes<T>::width > 8) with([](int lane) { return lane ^ 8; });
  if constexpr (Lanes<T>::width > 4) with([](int lane) { return lane ^ 4; });
  with([](int lane) { return lane ^ 2; });
  with([](int lane) { return lane ^ 1; });
  return lanes[0];
}

template <class T>
struct scalar_of_trait<Lanes<T>> {
  using type = T;
};

}  // namespace mpm
