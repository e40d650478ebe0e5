#pragma once
// What the loop of a filter does at a node beside the plugin's own update (abi.h, mpm_filter). Types as in motion.hpp.

#include "kernel/config.hpp"

namespace mpm {

/// The increment with what conditions and contact have made of the velocity that the plugin tried.
template <class V>
MPM_HD V corrected_increment(V increment, V velocity, V tried) {
  return increment + (velocity - tried);
}

/// One component's share of the squared mass norm.
template <class S>
MPM_HD S mass_norm_term(S mass, S increment) {
  return mass * increment * increment;
}

/// The velocity without what conditions and contact have added; and what they have added, out of both velocities.
template <class V>
MPM_HD V without(V velocity, V part) {
  return velocity - part;
}

}  // namespace mpm
