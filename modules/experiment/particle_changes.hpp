#pragma once
// What changes the number of a body's particles between steps: emitters, sinks, and particles that go over to another
// body.

#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "experiment/geometry.hpp"
#include "experiment/vector3.hpp"

namespace mpm {

/// Fills a region with particles of a body again and again, each time as the one before has moved on by its length.
struct Emitter {
  std::string name;
  int body = 0;  ///< index into Experiment::bodies
  std::shared_ptr<const Geometry> geometry;
  Vector3 velocity{};      ///< m/s
  double from = 0;         ///< s, when it is first filled
  double until = 0;        ///< s, when it ends
  double period = 0;       ///< s, from one batch to the next: length of the region along the velocity over the speed
  long max_particles = 0;  ///< most particles that its body may have
  std::string pointer;

  /// When batch `number` (from 0) is due, s.
  double due(long number) const { return from + static_cast<double>(number) * period; }
  /// How many batches are due up to a time, s; one at `until` itself is not.
  long batches_until(double time) const;
};

/// Takes particles out whose centre lies in a region.
struct Sink {
  std::string name;
  int body = -1;  ///< index of the body whose particles it takes; -1: of any
  std::shared_ptr<const Geometry> geometry;
  double from = 0, until = std::numeric_limits<double>::infinity();  ///< s, when it acts
  long every_steps = 10;  ///< steps from one look at the particles to the next
  std::string pointer;

  bool takes_from(int of_body) const { return body < 0 || body == of_body; }
};

/// When particles of a body go over to another one, and so to its material.
struct Becoming {
  int body = 0;                        ///< index of the body that they go over to
  std::string quantity;                ///< a quantity of particles (metrics/particle_quantities.hpp)
  std::optional<double> above, below;  ///< it goes over where the quantity is beyond any of the two
  long every_steps = 10;               ///< steps from one look at the particles to the next
  std::string pointer;

  bool meets(double value) const { return (above && value > *above) || (below && value < *below); }
};

}  // namespace mpm
