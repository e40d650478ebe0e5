#pragma once
// Sums of what supports give: walls, boxes of nodes, and grips. Vectors have three components, in 2-D the last one zero.

#include "kernel/config.hpp"

namespace mpm {

/// Adds an impulse at a place, kg m/s, and its moment about the origin, times a factor.
MPM_HD void add_impulse(double* impulse, double* moment, const double* place, const double* given, double factor = 1) {
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3, e = (c + 2) % 3;
    impulse[c] += factor * given[c];
    moment[c] += factor * (place[d] * given[e] - place[e] * given[d]);
  }
}

/// Adds what is given to a particle of a mass, kg, at x that comes to a velocity from another one, m/s: the impulse, its
/// moment, and the kinetic energy, J.
MPM_HD void add_given_to_particle(double* impulse, double* moment, double& energy, double mass, const double* x,
                                  const double* from, const double* to) {
  double given[3];
  for (int c = 0; c < 3; ++c) {
    given[c] = mass * (to[c] - from[c]);
    energy += 0.5 * given[c] * (to[c] + from[c]);
  }
  add_impulse(impulse, moment, x, given);
}

}  // namespace mpm
