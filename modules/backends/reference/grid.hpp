#pragma once
// The grid of the reference backend: every node of the domain and its padding, all values of a node side by side.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "simulation/backend.hpp"
#include "simulation/boundary.hpp"

namespace mpm::reference {

using Vector = Eigen::Vector3d;  ///< z = 0 in 2-D
using Matrix = Eigen::Matrix3d;

inline Vector to_eigen(const Vector3& v) {
  return {v[0], v[1], v[2]};
}

/// One velocity field at one node.
struct Node {
  double mass = 0;
  Vector momentum = Vector::Zero();         ///< kg m/s
  Vector internal_force = Vector::Zero();   ///< N
  Vector body_force = Vector::Zero();       ///< N
  Vector gravity_force = Vector::Zero();    ///< N
  double volume = 0;                        ///< sum w V, m^3
  Vector volume_gradient = Vector::Zero();  ///< sum V grad w, m^2
  Vector mass_position = Vector::Zero();    ///< sum w m (x_p - x_node), kg m
  Vector velocity_before = Vector::Zero();  ///< v-, m/s
  Vector velocity = Vector::Zero();         ///< v+ (or v- until the forces are applied), m/s

  Vector increment = Vector::Zero();         ///< v* of the filter, m/s
  Vector projected = Vector::Zero();         ///< S+ S v*, m/s (kg m/s until divided by the mass)
  Vector kept_velocity = Vector::Zero();     ///< unfiltered, where a pass restores it, m/s
  Vector constrained = Vector::Zero();       ///< what conditions and contact have added to `velocity` in this step, m/s
  Vector kept_constrained = Vector::Zero();  ///< of kept_velocity, m/s

  bool held[3] = {false, false, false};  ///< components that a condition gives now

  Vector force() const { return internal_force + body_force + gravity_force; }
  double kinetic_energy() const { return mass > 0 ? 0.5 * momentum.squaredNorm() / mass : 0.0; }
};

/// Components of a node's velocity that a condition gives.
struct Held {
  bool component[3] = {false, false, false};
  Vector velocity = Vector::Zero();
};

class Grid {
 public:
  explicit Grid(const Experiment& experiment);

  void reset();
  /// Before the remap of MUSL: masses, momenta and velocities only.
  void reset_momentum();

  /// Index of a node from its coordinates (periodic axes not wrapped: images are folded).
  std::size_t index(const Eigen::Vector3i& coordinates) const;
  bool contains(const Eigen::Vector3i& coordinates) const;
  int padding() const { return padding_[0]; }  ///< nodes beyond a wall
  Vector position(const Eigen::Vector3i& coordinates) const;
  Node& node(int field, std::size_t index) { return fields_[field][index]; }
  const Node& node(int field, std::size_t index) const { return fields_[field][index]; }
  int field_count() const { return static_cast<int>(fields_.size()); }
  std::size_t node_count() const { return coordinates_.size(); }
  std::uint64_t bytes() const { return fields_.size() * node_count() * sizeof(Node); }

  double kinetic_energy() const;
  /// sqrt(sum m v.v) over all nodes that hold mass: ghosts that were folded have none. kg^1/2 m/s.
  double mass_norm(Vector Node::*velocity) const;

  /// Sums periodic images: all channels. Done first, before anything is measured: images are one node.
  void sum_images(bool remap);
  /// Adds the masses, momenta and contact channels of ghosts beyond walls to their mirrors (boundary.hpp). A separating
  /// wall decides by p + dt f. `remap`: contact channels have been folded before.
  void fold_walls(double time, double dt, bool remap);
  /// The same for forces, which USF scatters later.
  void fold_forces();
  /// Gives ghosts the mirrored velocities. `time` is that of the wall's velocity.
  void fill_ghosts(double time);
  /// Folds the projection as momenta and masses were folded in this step, and divides it by the mass. `time`: that of
  /// the walls' velocity; nothing when the walls are at rest (what is projected is a difference).
  void fold_projection(std::optional<double> time);
  /// Gives ghosts the mirrored increments, walls at rest.
  void fill_increment_ghosts();
  /// What conditions hold at a node whose velocity would be `predicted` without them.
  Held held(std::size_t index, const Vector& predicted, double time) const;

 private:
  struct Fold {
    int field;
    std::size_t ghost, mirror;
    int axis, side;   ///< side < 0: a periodic image
    double mass = 0;  ///< of the ghost when it was folded, kg
  };
  void fold_axis(int axis, double time, double dt, bool remap);
  void fold_node(Fold fold, double time, bool remap);
  static void fold_onto_itself(Node& node, int axis);
  bool approaches_wall(const Fold& fold, double dt) const;
  Vector wall_velocity(const Fold& fold, double time) const;
  static Vector mirrored(const Vector& v, const Fold& fold, ConditionType as);
  ConditionType type_of(const Fold& fold) const;

  const Experiment& experiment_;
  Eigen::Vector3i extent_, padding_;
  std::vector<Eigen::Vector3i> coordinates_;
  std::array<std::vector<std::size_t>, 3> outermost_first_;  ///< nodes by distance beyond the walls of an axis
  std::vector<std::vector<Node>> fields_;
  std::vector<Fold> folds_;
};

}  // namespace mpm::reference
