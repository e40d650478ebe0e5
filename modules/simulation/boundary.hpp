#pragma once
// The policy at the edges of the domain: one for all shapes, in terms that all backends use.
//
// Nodes run from -padding to cells + padding on each axis; walls stand on nodes 0 and cells. Nodes beyond a wall are
// ghosts.
//  stick, slip, prescribed: the material continues beyond the wall as its mirror image. A ghost's mass, momentum and
//    force are folded onto its mirror node with the sign of `mirror_sign`; afterwards it takes the mirrored velocity.
//    Components with sign -1 vanish on the wall itself. Momenta are those relative to the wall's velocity. Gravity is a
//    force like the others: a ghost of mass m folds m g with the same signs (so the mirror node's weight is (m + sign
//    m_ghost) g by component, not (m + m_ghost) g). The wall's velocity is taken at the foot of the node on the wall,
//    at t for v- and at t + dt for v+.
//  A wall that is held at a temperature mirrors the heat beyond it relative to that temperature, with the other sign; all
//    other walls mirror it as it is.
//  separate: ghosts fold as slip while the mirrored pair approaches (predicted with the forces), else they are ordinary
//    nodes; nodes on the wall are held while they would move into it.
//  free: ghosts are ordinary nodes.
//  periodic: a node is its index modulo the number of cells.
// Periodic images are summed first; then walls are folded in the order x, y, z; ghosts are filled in the reverse order,
// so corners are right.

#include "experiment/experiment.hpp"
#include "operators/edges.hpp"
#include "plan/field.hpp"

namespace mpm {

/// The number of nodes beyond a wall that a tensor-product stencil may touch.
inline constexpr int grid_padding = 3;
/// The same number for a list of nodes, as domains grow with the deformation; a run whose lists reach farther stops.
inline constexpr int list_grid_padding = 8;
inline int grid_padding_of(const mpm_shape& shape) {
  return shape.form == MPM_NODE_LIST ? list_grid_padding : grid_padding;
}

static_assert(static_cast<int>(ConditionType::free) == wall_free &&
              static_cast<int>(ConditionType::stick) == wall_stick &&
              static_cast<int>(ConditionType::slip) == wall_slip &&
              static_cast<int>(ConditionType::separate) == wall_separate &&
              static_cast<int>(ConditionType::prescribed) == wall_prescribed &&
              static_cast<int>(ConditionType::periodic) == wall_periodic);
static_assert(static_cast<int>(AtWall::none) == rule_none && static_cast<int>(AtWall::even) == rule_even &&
              static_cast<int>(AtWall::momentum) == rule_momentum && static_cast<int>(AtWall::vector) == rule_vector &&
              static_cast<int>(AtWall::heat) == rule_heat && static_cast<int>(AtWall::heat_rate) == rule_heat_rate &&
              static_cast<int>(AtWall::slip) == rule_slip);

// These overloads take the types of an experiment and a plan to the decisions of operators/edges.hpp.
constexpr double mirror_sign(ConditionType type, int axis, int component) {
  return mirror_sign(static_cast<int>(type), axis, component);
}
inline bool holds_temperature(const FaceCondition& face) {
  return face.thermal.exchange == HeatExchange::fixed_temperature;
}
inline double mirror_sign(AtWall rule, const FaceCondition& face, int axis, int component) {
  return mirror_sign(static_cast<int>(rule), static_cast<int>(face.type), holds_temperature(face), axis, component);
}
constexpr bool folds(ConditionType type) {
  return folds(static_cast<int>(type));
}
constexpr bool has_images(ConditionType type) {
  return has_images(static_cast<int>(type));
}
constexpr bool holds(ConditionType type, int axis, int component) {
  return holds(static_cast<int>(type), axis, component);
}

}  // namespace mpm
