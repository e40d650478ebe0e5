// The larger and the smaller of two values for tests: std::max and std::min lose what is no number where it comes second,
// so that the largest difference from a wrong program would be a small one.
#pragma once

#include <cmath>
#include <type_traits>

namespace mpm::test {

template <class Value>
bool is_no_number(Value value) {
  if constexpr (std::is_floating_point_v<Value>) return std::isnan(value);
  return false;
}

/// The larger of two values; what is no number where one of them is none.
template <class A, class B>
std::common_type_t<A, B> larger(A a, B b) {
  const std::common_type_t<A, B> first = a, second = b;
  return second <= first || is_no_number(first) ? first : second;
}

/// The smaller of two values; what is no number where one of them is none.
template <class A, class B>
std::common_type_t<A, B> smaller(A a, B b) {
  const std::common_type_t<A, B> first = a, second = b;
  return first <= second || is_no_number(first) ? first : second;
}

}  // namespace mpm::test
