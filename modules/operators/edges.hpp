#pragma once
// Formulas at the edges of the domain and in boxes of nodes: who holds what, and how mirror images are added and taken.
// simulation/boundary.hpp states the policy. A velocity may be a component, a vector, or a pack of nodes.

#include "kernel/config.hpp"

namespace mpm {

/// The kind of a condition, in the order of ConditionType, which simulation/boundary.hpp checks.
enum Wall : int { wall_free = 0, wall_stick, wall_slip, wall_separate, wall_prescribed, wall_periodic };

/// The rule by which a wall folds a field, in the order of AtWall.
enum Rule : int { rule_none = 0, rule_even, rule_momentum, rule_vector, rule_heat, rule_heat_rate, rule_slip };

/// Returns the sign with which a wall normal to `axis` mirrors component `component` of a vector. Images at periodic
/// faces are taken as they are.
MPM_HD constexpr int mirror_sign(int wall, int axis, int component) {
  if (wall == wall_periodic) return 1;
  if (wall == wall_stick || wall == wall_prescribed) return -1;
  return component == axis ? -1 : 1;
}

/// Returns the sign for a field with this rule, at a wall that may be held at a temperature.
MPM_HD constexpr int mirror_sign(int rule, int wall, bool holds_temperature, int axis, int component) {
  if (wall == wall_periodic || rule == rule_none || rule == rule_even) return 1;
  if (rule == rule_heat || rule == rule_heat_rate) return holds_temperature ? -1 : 1;
  return mirror_sign(rule == rule_slip ? int(wall_slip) : wall, axis, component);
}

/// Whether a field is mirrored relative to the wall, that is, to the momentum or heat that the ghost would have with
/// the wall's own velocity or temperature.
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

/// The node that a node of an axis with images is added to: itself, unless it lies beyond a face.
MPM_HD constexpr int image_of(int node, int cells, bool periodic) {
  if (periodic) return ((node % cells) + cells) % cells;
  return node < 0 ? -node : node > cells ? 2 * cells - node : node;
}

/// Whether a wall of this kind holds `component` on its own nodes; a separating one decides by `wall_holds`.
MPM_HD constexpr bool holds(int wall, int axis, int component) {
  return folds(wall) && mirror_sign(wall, axis, component) < 0;
}

/// The mirror image of a value: it has the wall's sign and is relative to the value of the wall itself.
template <class V, class Sign>
MPM_HD V mirrored(V value, Sign sign, V of_wall) {
  return of_wall + sign * (value - of_wall);
}

/// The velocity that a node will have after the forces, by which separating walls decide whether they fold.
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

/// Whether a grip holds a node: at least half of the node's mass is of its particles. Half of it counts as half however its
/// sum is rounded: rows of particles often lie evenly about a node.
template <class S>
MPM_HD bool grip_holds(S mass_of_grip, S mass) {
  return mass_of_grip > S(0) && S(2) * mass_of_grip >= S(1 - 1e-5) * mass;
}

}  // namespace mpm
