#pragma once
// A scalar that counts what is done with it: functors run over it as they run over lanes, so that the count of a step
// is that of the code, not an estimate. Host only.
//
// +, -, *, / and sqrt count 1 each. log and exp count the operations of their polynomials in kernel/lanes.hpp. Signs,
// comparisons, minima, selections and roundings count nothing.

#include <cmath>
#include <type_traits>

#include "kernel/math.hpp"

namespace mpm {

/// Operations of this thread since it was last set to zero. Only count_operations() sets it, and puts back what it
/// found, so that counts are as independent of each other as those of a local variable.
inline thread_local long counted_operations = 0;

template <class T>
struct Counted {
  T value;

  Counted() = default;
  constexpr Counted(T x) : value(x) {}
  template <class U>
  requires(std::is_arithmetic_v<U> && !std::is_same_v<U, T>) constexpr Counted(U x) : value(static_cast<T>(x)) {}
  explicit operator int() const { return static_cast<int>(value); }

  /// log: (m - 1) / (m + 1), its square, the series to s^9 (s^23 in double), and e ln 2 in two parts.
  static constexpr long log_operations = 4 + 2 * (sizeof(T) == 4 ? 3 : 10) + 9;
  /// exp: n, the remainder in two parts, the series of 7 (13) terms of 3 operations, the scale.
  static constexpr long exp_operations = 2 + 4 + 3 * (sizeof(T) == 4 ? 7 : 13) + 1;

  static constexpr Counted counted(T x, long by = 1) {
    counted_operations += by;
    return Counted(x);
  }
  friend Counted operator+(Counted a, Counted b) { return counted(a.value + b.value); }
  friend Counted operator-(Counted a, Counted b) { return counted(a.value - b.value); }
  friend Counted operator*(Counted a, Counted b) { return counted(a.value * b.value); }
  friend Counted operator/(Counted a, Counted b) { return counted(a.value / b.value); }
  friend Counted operator-(Counted a) { return Counted(-a.value); }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  friend bool operator<(Counted a, Counted b) { return a.value < b.value; }
  friend bool operator>(Counted a, Counted b) { return a.value > b.value; }
  friend bool operator<=(Counted a, Counted b) { return a.value <= b.value; }
  friend bool operator>=(Counted a, Counted b) { return a.value >= b.value; }
  friend bool operator==(Counted a, Counted b) { return a.value == b.value; }
  friend bool operator!=(Counted a, Counted b) { return a.value != b.value; }

  friend Counted sqrt(Counted a) { return counted(std::sqrt(a.value)); }
  friend Counted log(Counted a) { return counted(std::log(a.value), log_operations); }
  friend Counted exp(Counted a) { return counted(std::exp(a.value), exp_operations); }
  friend Counted floor(Counted a) { return Counted(std::floor(a.value)); }
  friend Counted abs(Counted a) { return Counted(std::abs(a.value)); }
  friend Counted min(Counted a, Counted b) { return a < b ? a : b; }
  friend Counted max(Counted a, Counted b) { return a > b ? a : b; }
  friend Counted select(bool mask, Counted a, Counted b) { return mask ? a : b; }
};

/// Operations that `run` does.
template <class Run>
long count_operations(Run&& run) {
  const long before = counted_operations;
  counted_operations = 0;
  run();
  const long result = counted_operations;
  counted_operations = before;
  return result;
}

}  // namespace mpm
