#pragma once
// What is looked at in every row of a run because warnings are made of it.

#include "simulation/simulation.hpp"

namespace mpm::app {

/// A gap between fields, in cells, across which nothing should act.
inline constexpr double open_gap = 0.4;

/// What was seen of contact. Only laws that detect surfaces are watched.
struct Seen {
  double largest_force = 0;  ///< N
  double apart_force = 0;    ///< N, the largest force in a row where no node touched
  double early_force = 0;    ///< N, the largest force before the fields were first nearer than `open_gap`
  double early_gap = 0;      ///< m, between the particles of the fields when that force acted
  double slide = 0;          ///< m, way along the surface that two fields with contact slid on each other
  double time = 0;           ///< s, of the last row
  bool met = false;          ///< the fields have been nearer than `open_gap` in a row with a force
  bool in_contact = false;   ///< in the last row
};

class Watch {
 public:
  explicit Watch(const Simulation& simulation);
  /// Looks at the state after a step that is recorded.
  void look();
  const Seen& seen() const { return seen_; }
  Seen& seen() { return seen_; }

 private:
  double sliding_speed() const;

  const Simulation& simulation_;
  bool watches_, watches_slide_;
  Seen seen_;
};

/// The body with corners that slides at the cost of a wrong drag where its shape is a B-spline: one whose surface is not
/// curved and that does not reach through the domain. Null where there is none, or its ends do not tilt the normal.
const BodySpecification* finite_block(const Experiment& experiment);

}  // namespace mpm::app
