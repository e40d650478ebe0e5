#pragma once
// Elementary functions over plain scalars, under the same names as over lanes, so that one functor source serves both.
// The device pass (NVRTC, or g++ standing in for it) has no system headers: it sees the compiler's own functions.

#include "kernel/config.hpp"

#if MPM_HOST
#include <cmath>
#define MPM_MATH(name) std::name
#elif defined(__CUDACC_RTC__)
#define MPM_MATH(name) ::name
#else
#define MPM_MATH(name) __builtin_##name
#endif

namespace mpm {

/// The plain scalar behind S: float, double; lanes specialise it.
template <class S>
struct scalar_of_trait {
  using type = S;
};
template <class S>
using scalar_of = typename scalar_of_trait<S>::type;

#if defined(MPM_DEVICE_PASS) && !defined(__CUDACC_RTC__)
#define MPM_UNARY(name)            \
  MPM_HD float name(float x) {     \
    return __builtin_##name##f(x); \
  }                                \
  MPM_HD double name(double x) {   \
    return __builtin_##name(x);    \
  }
#else
#define MPM_UNARY(name)          \
  MPM_HD float name(float x) {   \
    return MPM_MATH(name)(x);    \
  }                              \
  MPM_HD double name(double x) { \
    return MPM_MATH(name)(x);    \
  }
#endif
MPM_UNARY(sqrt)
MPM_UNARY(log)
MPM_UNARY(exp)
MPM_UNARY(floor)
#undef MPM_UNARY

MPM_HD float abs(float x) {
  return x < 0 ? -x : x;
}
MPM_HD double abs(double x) {
  return x < 0 ? -x : x;
}
MPM_HD float min(float a, float b) {
  return a < b ? a : b;
}
MPM_HD double min(double a, double b) {
  return a < b ? a : b;
}
MPM_HD float max(float a, float b) {
  return a > b ? a : b;
}
MPM_HD double max(double a, double b) {
  return a > b ? a : b;
}
/// `a` where the mask holds, else `b`.
MPM_HD float select(bool mask, float a, float b) {
  return mask ? a : b;
}
MPM_HD double select(bool mask, double a, double b) {
  return mask ? a : b;
}
MPM_HD bool any(bool mask) {
  return mask;
}
/// Whether any lane of a mask is set.
template <class Mask>
MPM_HD bool any(const Mask& mask) {
  bool result = false;
  for (unsigned i = 0; i < sizeof(Mask) / sizeof(mask[0]); ++i) result = result || mask[i] != 0;
  return result;
}

/// Value of a constant in the scalar type behind S.
template <class S>
MPM_HD constexpr scalar_of<S> real(double x) {
  return static_cast<scalar_of<S>>(x);
}

}  // namespace mpm
