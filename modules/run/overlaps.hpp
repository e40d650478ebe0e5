#pragma once
// Bodies that begin in one place: what was meant to stand side by side counts double there, and no law pushes it out of a
// rigid body.

#include <cstddef>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm::app {

/// How two bodies overlap at the start. A particle lies in another body where it is nearer than half a spacing, along every
/// axis, to a particle of that.
struct Overlap {
  int first = 0, second = 0;                ///< bodies, the first the one that comes first in the file
  std::size_t of_first = 0, of_second = 0;  ///< particles of each that lie in the other
  bool identical = false;                   ///< each particle of one is in the place of one of the other

  /// What is wrong, with numbers and remedy.
  std::string text(const Experiment& experiment) const;
};

/// The pairs of bodies of which one has most of its particles in the other.
std::vector<Overlap> overlaps_of(const Experiment& experiment);

/// A body of which particles begin inside a rigid body, or an emitter whose region lies in one that is at rest.
struct RigidOverlap {
  int body = 0, rigid_body = 0;
  int emitter = -1;  ///< that fills the body; -1 for the particles that it begins with
  std::size_t particles = 0;
  double deepest = 0;  ///< m, below the rigid body's surface

  /// What is wrong, with numbers and remedy.
  std::string text(const Experiment& experiment) const;
};

std::vector<RigidOverlap> rigid_overlaps_of(const Experiment& experiment);

}  // namespace mpm::app
