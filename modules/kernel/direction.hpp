#pragma once
// Unit vectors along sums that may vanish: what normals of contact share. Device-safe.

#include "kernel/functor.hpp"

namespace mpm {

/// Gives a vector unit length. Returns 1, or 0 where it is zero or no number; it is then any vector.
template <int D, class S>
MPM_HD S make_unit(Vec<D, S>& v) {
  const scalar_of<S> zero = 0, one = 1;
  // The larger of the first two squares is looked at for itself, so that both are rounded before they are added, with or
  // without fused operations; results of the default normal were made so.
  const S first = v[0] * v[0], second = v[1] * v[1];
  S squared = first + second, largest = max(first, second);
  for (int i = 2; i < D; ++i) squared = squared + v[i] * v[i], largest = max(largest, squared);
  const S length = sqrt(squared);
  const S divisor = select(length > zero, length, S(one));
  const S found = select(largest > zero, select(length > zero, S(one), S(zero)), S(zero));
  for (int i = 0; i < D; ++i) v[i] = v[i] / divisor;
  return found;
}

}  // namespace mpm
