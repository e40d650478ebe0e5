#pragma once
// The edges of the domain and boxes of nodes: who holds what, and how a mirror image is added and taken. The policy is
// told in simulation/boundary.hpp. A velocity may be one component, a vector of them, or a pack of several nodes.

#include "kernel/config.hpp"

namespace mpm {

/// A condition's kind, in the order of ConditionType (simulation/boundary.hpp checks it).
enum Wall : int { wall_free = 0, wall_stick, wall_slip, wall_separate, wall_prescribed, wall_periodic };

/// How a field is folded at a wall, in the order of AtWall.
enum Rule : int { rule_none = 0, rule_even, rule_momentum, rule_vector, rule_heat, rule_heat_rate, rule_slip };

/// Sign with which component `component` of a vector is mirrored at a wall normal to `axis`; images at periodic faces
/// are taken as they are.
MPM_HD constexpr int mirror_sign(int wall, int axis, int component) {
  if (wall == wall_periodic) return 1;
  if (wall == wall_stick || wall == wall_prescribed) return -1;
  return component == axis ? -1 : 1;
}

/// The same of a field with this rule, at a wall that is held at a temperature or not.
MPM_HD constexpr int mirror_sign(int rule, int wall, bool holds_temperature, int axis, int component) {
  if (wall == wall_periodic || rule == rule_none || rule == rule_even) return 1;
  if (rule == rule_heat || rule == rule_heat_rate) return holds_temperature ? -1 : 1;
  return mirror_sign(rule == rule_slip ? int(wall_slip) : wall, axis, component);
}

/// Whether what is mirrored is relative to what the wall's own velocity or temperature makes of the ghost's mass or heat
/// capacity.
MPM_HD constexpr bool is_relative_to_wall(int rule) {
  return rule == rule_momentum || rule == rule_heat;
}

/// Whether the material continues beyond a wall as its mirror image.
MPM_HD constexpr bool folds(int wall) {
  return wall == wall_stick || wall == wall_slip || wall == wall_separate || wall == wall_prescribed;
}

/// Whether nodes beyond a face with this condition are added to others.
MPM_HD constexpr bool has_images(int wall) {
  return folds(wall) || wall == wall_periodic;
}

/// Node that a node of an axis with images is added to: itself, unless it lies beyond a face.
MPM_HD constexpr int image_of(int node, int cells, bool periodic) {
  if (periodic) return ((node % cells) + cells) % cells;
  return node < 0 ? -node : node > cells ? 2 * cells - node : node;
}

/// Whether a wall of this kind holds `component` on its own nodes; a separating one decides by `wall_holds`.
MPM_HD constexpr bool holds(int wall, int axis, int component) {
  return folds(wall) && mirror_sign(wall, axis, component) < 0;
}

/// A value as its mirror image shows it: with the wall's sign, relative to the value of the wall itself.
template <class V, class Sign>
MPM_HD V mirrored(V value, Sign sign, V of_wall) {
  return of_wall + sign * (value - of_wall);
}

/// The velocity that a node will have after the forces; folding of separating walls goes by it.
template <class V, class M, class S>
MPM_HD V predicted_velocity(V momentum, V force, M mass, S dt) {
  return (momentum + dt * force) / mass;
}

/// Whether a node and its ghost whose velocities along the wall's axis sum to `speed` approach the wall; side 0 is the
/// lower one.
template <class S>
MPM_HD bool approaches(int side, S speed) {
  return side == 0 ? speed < S(0) : speed > S(0);
}

/// Whether a wall gives `component` of a node on it that moves at `across` along the wall's axis: a separating wall
/// holds what moves into it.
template <class S>
MPM_HD bool wall_holds(int wall, int axis, int side, int component, S across) {
  return holds(wall, axis, component) && (wall != wall_separate || approaches(side, across));
}

/// Whether a box of conditions gives `component` of a node that moves at `now` along it. `side` is +1 where a
/// separating box lets material leave towards +axis only; bit c of `given` is set where a prescribed box gives
/// component c.
template <class S>
MPM_HD bool box_holds(int type, int axis, int side, int given, int component, S now) {
  const bool on_axis = component == axis;
  return type == wall_stick || (type == wall_slip && on_axis) ||
         (type == wall_separate && on_axis && S(side) * now < S(0)) ||
         (type == wall_prescribed && (given >> component & 1));
}

}  // namespace mpm
