#pragma once
// The arguments that the host hands to functors, and the tables that describe them. Device-safe.

#include "kernel/tensor.hpp"

namespace mpm {

/// What a particle takes back from the grid. Only the moments a transfer declares are filled.
template <int D, class S>
struct GatheredMoments {
  Vec<D, S> velocity;            ///< sum w v+, m/s
  Vec<D, S> velocity_increment;  ///< sum w (v+ - v-), m/s
  Mat<D, S> affine;              ///< sum v+ (x) w D^-1 d, 1/s
  Mat<D, S> velocity_gradient;   ///< sum v+ (x) grad w, 1/s
  Mat<D, S> second_moment;       ///< D = sum w d d^T, cells^2, or any multiple of the identity that it is
};

/// The nodes of one particle, each once; lengths in cells. `T` is a plain scalar: lists are made particle by particle.
template <int D, class T, int Capacity>
struct NodeList {
  static constexpr int capacity = Capacity;
  int count;
  int node[Capacity][D];
  T weight[Capacity];
  T gradient[Capacity][D];  ///< derivative by the particle's position
};

/// Two velocity fields that meet at a node.
template <int D, class S>
struct ContactPair {
  S mass_a, mass_b;                  ///< kg
  Vec<D, S> momentum_a, momentum_b;  ///< kg m/s
  Vec<D, S> normal;                  ///< unit, from a to b
  S separation;                      ///< m, negative when the surfaces overlap
  S area;                            ///< m^2
  scalar_of<S> dt;                   ///< s
};

template <int D, class S>
struct ContactResult {
  Vec<D, S> impulse;  ///< added to a and taken from b, kg m/s
  S dissipated;       ///< J
  S status;           ///< 0 apart, 1 sticks, 2 slips
};

/// State of solids that keep F alone, declared as MPM_STATE_PLANE_DEFORMATION: `Gradient` is a Mat, or in axisymmetric
/// scenes a Deformation.
template <class Gradient>
struct ElasticState {
  Gradient deformation_gradient;
};

}  // namespace mpm

// Tables of parameters and state stand beside the functor, so that one file holds the method. The device pass skips
// them.
#if MPM_HOST
#include <cstddef>
#include <limits>

#include "plugin/abi.h"
namespace mpm {
inline constexpr double unbounded = std::numeric_limits<double>::infinity();
inline constexpr double required = std::numeric_limits<double>::quiet_NaN();
}  // namespace mpm

/// Rows of a parameter table; `member` names both the key in the file and the double in Parameters.
#define MPM_NUMBER_PARAMETER(member, unit, default_value, minimum, maximum, flags, doc)             \
  {                                                                                                 \
#member, unit, doc, "", MPM_NUMBER,                                                             \
        static_cast < uint32_t>((flags) | ((default_value) == (default_value) ? 0 : MPM_REQUIRED)), \
        offsetof(Parameters, member), 0, default_value, minimum, maximum                            \
  }
#define MPM_INTEGER_PARAMETER(member, default_value, minimum, maximum, doc)                   \
  {                                                                                           \
#member, "", doc, "", MPM_INTEGER, (default_value) == (default_value) ? 0 : MPM_REQUIRED, \
        offsetof(Parameters, member), 0, default_value, minimum, maximum                      \
  }
#define MPM_BOOLEAN_PARAMETER(member, default_value, doc) \
  { #member, "", doc, "", MPM_BOOLEAN, 0, offsetof(Parameters, member), 0, default_value, 0, 1 }
#define MPM_CHOICE_PARAMETER(member, choices, default_index, doc) \
  { #member, "", doc, choices, MPM_CHOICE, 0, offsetof(Parameters, member), 0, default_index, 0, 0 }
#endif
