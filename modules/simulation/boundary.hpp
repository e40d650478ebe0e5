#pragma once
// The policy at the edges of the domain, one for all shapes, in the terms both backends use.
//
// Nodes run from -padding to cells + padding on each axis; walls stand on nodes 0 and cells. Nodes beyond a wall are
// ghosts.
//  stick, slip, prescribed: the material continues beyond the wall as its mirror image. A ghost's mass, momentum and
//  force
//    are folded onto its mirror node with the sign of `mirror_sign`; afterwards it takes the mirrored velocity.
//    Components with sign -1 vanish on the wall itself. Momenta are those relative to the wall's velocity. Gravity is a
//    force like the others: a ghost of mass m folds m g with the same signs (so the mirror node's weight is (m + sign
//    m_ghost) g by component, not (m + m_ghost) g). The wall's velocity is taken at the foot of the node on the wall,
//    at t for v- and at t + dt for v+.
//  separate: ghosts fold as slip while the mirrored pair approaches (predicted with the forces), else they are ordinary
//    nodes; nodes on the wall are held while they would move into it.
//  free: ghosts are ordinary nodes.
//  periodic: a node is its index modulo the number of cells.
// Periodic images are summed first; then walls are folded in the order x, y, z; ghosts are filled in the reverse order,
// so corners are right.

#include "experiment/experiment.hpp"
#include "plan/field.hpp"

namespace mpm {

/// Nodes beyond a wall that a tensor-product stencil may touch.
inline constexpr int grid_padding = 3;
/// The same of a list of nodes, whose particles grow with their deformation; beyond it a run stops with the reason.
inline constexpr int list_grid_padding = 8;
inline int grid_padding_of(const mpm_shape& shape) {
  return shape.form == MPM_NODE_LIST ? list_grid_padding : grid_padding;
}

/// Why a run ends in which a particle comes to r <= 0.
inline constexpr const char* reached_axis = "reached the axis r = 0, where its ring has no circumference";

/// Sign with which component `component` of a vector is mirrored at a wall normal to `axis`.
constexpr double mirror_sign(ConditionType type, int axis, int component) {
  if (type == ConditionType::stick || type == ConditionType::prescribed) return -1;
  return component == axis ? -1 : 1;
}

/// The same at a face with this condition for fields with this rule; images at periodic faces are added as they are.
constexpr double mirror_sign(AtWall rule, ConditionType type, int axis, int component) {
  if (type == ConditionType::periodic || rule == AtWall::none || rule == AtWall::even) return 1;
  return mirror_sign(rule == AtWall::slip ? ConditionType::slip : type, axis, component);
}

constexpr bool folds(ConditionType type) {
  return type == ConditionType::stick || type == ConditionType::slip || type == ConditionType::prescribed ||
         type == ConditionType::separate;
}

/// Whether nodes beyond a face with this condition are added to others.
constexpr bool has_images(ConditionType type) {
  return folds(type) || type == ConditionType::periodic;
}

/// Node that a node of an axis with images is added to: itself, unless it lies beyond a face.
constexpr int image_of(int node, int cells, bool periodic) {
  if (periodic) return ((node % cells) + cells) % cells;
  return node < 0 ? -node : node > cells ? 2 * cells - node : node;
}

/// Whether a wall of this type holds `component` on its own nodes (separate decides by approach).
constexpr bool holds(ConditionType type, int axis, int component) {
  return folds(type) && mirror_sign(type, axis, component) < 0;
}

}  // namespace mpm
