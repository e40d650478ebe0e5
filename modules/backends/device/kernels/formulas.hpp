#pragma once
// The functions that formulas of an experiment call, and what a kernel does with those that the composer has written into
// Scene (backends/device/particle_formulas.hpp).

#include "backends/device/kernels/arrays.hpp"
#include "kernel/math.hpp"

namespace mpm::device {

/// The operations of experiment/formula.hpp that are functions.
namespace formulas {

using mpm::abs;
using mpm::exp;
using mpm::floor;
using mpm::log;
using mpm::sqrt;

#if defined(__CUDACC_RTC__)
#define MPM_FLOAT_FUNCTION(name) ::name##f
#else
#define MPM_FLOAT_FUNCTION(name) __builtin_##name##f
#endif
#define MPM_UNARY(name)                 \
  MPM_HD float name(float a) {          \
    return MPM_FLOAT_FUNCTION(name)(a); \
  }                                     \
  MPM_HD double name(double a) {        \
    return MPM_MATH(name)(a);           \
  }
#define MPM_BINARY(name)                   \
  MPM_HD float name(float a, float b) {    \
    return MPM_FLOAT_FUNCTION(name)(a, b); \
  }                                        \
  MPM_HD double name(double a, double b) { \
    return MPM_MATH(name)(a, b);           \
  }
MPM_UNARY(sin)
MPM_UNARY(cos)
MPM_UNARY(tan)
MPM_UNARY(asin)
MPM_UNARY(acos)
MPM_UNARY(atan)
MPM_UNARY(sinh)
MPM_UNARY(cosh)
MPM_UNARY(tanh)
MPM_BINARY(atan2)
MPM_BINARY(pow)
#undef MPM_UNARY
#undef MPM_BINARY
#undef MPM_FLOAT_FUNCTION

template <int D, class T>
MPM_HD void add(Vec<D, T>& sum, const Vec<D, T>& value) {
  for (int c = 0; c < D; ++c) sum[c] += value[c];
}

}  // namespace formulas

/// Whether every component is a finite number.
template <int D, class T>
MPM_HD bool all_finite(const Vec<D, T>& values) {
  bool finite = true;
  for (int c = 0; c < D; ++c) finite = finite && is_number(double(values[c]));
  return finite;
}

/// Where a particle is and where it began, as formulas ask; no formula reads the latter where it has no field.
template <class Scene>
struct FormulaPlace {
  using T = typename Scene::Scalar;
  using P = typename Scene::Particle;
  Vec<Scene::dimension, T> x, X;

  MPM_HD FormulaPlace(const ParticleArrays<T>& particles, int p)
      : x(load<Scene::dimension>(particles.field[P::position], particles.stride, p)), X(x) {
    if constexpr (P::initial_position >= 0)
      X = load<Scene::dimension>(particles.field[P::initial_position], particles.stride, p);
  }
};

}  // namespace mpm::device
