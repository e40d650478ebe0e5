#pragma once
// Rigid bodies that move as they are told: where they are, and once a step the nodes that lie in them or beside them. All
// backends go through these lists; positions do not move within a step, so that each holds for every stage of it.

#include <array>
#include <vector>

#include "operators/rigid_contact.hpp"
#include "simulation/backend.hpp"

namespace mpm {

/// A node near a rigid body.
struct RigidNode {
  std::array<int, 3> at{};  ///< its coordinates
  RigidSurface surface{};
  Vector3 arm{};  ///< from the body's point of reference, m
};

/// The motion of a rigid body at a moment.
struct RigidMotion {
  Vector3 velocity{}, spin{};  ///< m/s, rad/s

  Vector3 velocity_at(const Vector3& arm) const;
};

/// What a law does to material at a rigid body, summed over nodes.
struct RigidGiven {
  Vector3 impulse{}, moment{};      ///< on the material, kg m/s, and its moment about the origin
  double dissipated = 0;            ///< J, as the law says
  double driven = 0;                ///< J, work of the body: impulses times its own velocity
  long sticking = 0, slipping = 0;  ///< nodes
  double largest_penetration = 0;   ///< m

  /// Takes what the law gives a node at x, m, where the body moves with `velocity`.
  void give(const Vector3& x, const Vector3& impulse, const Vector3& velocity);
  /// Takes what the law says of it.
  void count(std::int32_t status, double separation, double heat);
  void add(const RigidGiven& other);
  /// Adds it to the record of contact, which counts the nodes at rigid bodies too.
  void add_to(ContactRecord& record) const;
};

class RigidBodies {
 public:
  explicit RigidBodies(const Experiment& experiment);

  std::size_t count() const { return states_.size(); }
  const Component& law(std::size_t body) const { return experiment_.rigid_bodies[body].contact; }
  /// Finds the nodes near each body where it is now: those in it, down to a few cells, and those outside it by rigid_reach.
  void begin_step();
  const std::vector<RigidNode>& nodes(std::size_t body) const { return nodes_[body]; }
  /// Whether the nodes of now may be others than those of the step before.
  bool has_moved(std::size_t body) const { return has_moved_[body]; }
  RigidMotion motion(std::size_t body, double time) const;
  /// The length of a node's ring in axisymmetric scenes, m, else 1.
  double around(const RigidNode& node) const;
  /// Where a node lies, m.
  Vector3 place(const RigidNode& node) const { return place_of(node.at); }
  /// Moves all bodies by the motion of the step's end, as particles move.
  void end_step(const StepInfo& step);

  const std::vector<RigidState>& states() const { return states_; }
  /// Goes on from saved states, of as many bodies.
  void resume(std::vector<RigidState> states);

 private:
  void find_nodes(std::size_t body);
  void look_at(std::size_t body, const std::array<int, 3>& node);
  Vector3 place_of(const std::array<int, 3>& node) const;
  /// Where a place of now was at the start, as the body has taken it with it.
  Vector3 at_start(std::size_t body, const Vector3& x) const;
  double distance(std::size_t body, const Vector3& x) const;

  const Experiment& experiment_;
  std::vector<RigidState> states_;
  std::vector<std::vector<RigidNode>> nodes_;
  std::vector<bool> has_moved_;
  bool found_ = false;  ///< the nodes of bodies that rest are known
};

}  // namespace mpm
