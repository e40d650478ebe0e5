#pragma once
// Formulas of a filter's loop at a node, beside the plugin's update (abi.h, mpm_filter). Types are as in motion.hpp.

#include "kernel/config.hpp"

namespace mpm {

/// The increment plus what conditions and contact have changed of the velocity that the plugin tried.
template <class V>
MPM_HD V corrected_increment(V increment, V velocity, V tried) {
  return increment + (velocity - tried);
}

/// The share of one component in the squared mass norm.
template <class S>
MPM_HD S mass_norm_term(S mass, S increment) {
  return mass * increment * increment;
}

/// The velocity without what conditions and contact have added, or, given that velocity, what they have added.
template <class V>
MPM_HD V without(V velocity, V part) {
  return velocity - part;
}

}  // namespace mpm
