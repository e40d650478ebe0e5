#pragma once
// Bodies touch where their mean positions are as far apart as a number says that is typed in, as in other programs.
// Nairn, CMES 92 (2013) 271-299.

#include "kernel/functor.hpp"
#if MPM_HOST
#include "plugin/tables.hpp"
#endif

namespace mpm {

struct FixedOffset {
  struct Parameters {
    double offset;
  };

  /// The gap in cells.
  template <class S>
  MPM_HD static S gap(const Parameters& p, const DetectionPair<S>& pair) {
    return pair.mean_b - pair.mean_a - S(real<S>(p.offset));
  }

#if MPM_HOST
  static constexpr unsigned traits = MPM_READS_MEAN_POSITION;
  static constexpr mpm_parameter parameters[] = {
      MPM_NUMBER_PARAMETER(offset, "", 0.8, 0.0, 4.0, 0, "cells between the mean positions of bodies that touch"),
  };
#endif
};

}  // namespace mpm
