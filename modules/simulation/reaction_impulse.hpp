#pragma once
// Counts the momentum that particles take from each support in a step: whoever holds a node, or folds what lies beyond a
// wall, notes it here. All of it is linear, so that a filter's loop keeps, restores and adds it like a velocity.

#include <array>
#include <vector>

#include "simulation/backend.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/grips.hpp"

namespace mpm {

/// Impulses, kg m/s, and their moments about the origin by the number of the support.
class SupportImpulses {
 public:
  explicit SupportImpulses(std::size_t count = 0) : sums_(count) {}
  void clear() { sums_.assign(sums_.size(), {}); }
  void add(int support, const Vector3& place, const Vector3& impulse, double factor = 1);
  /// Adds an impulse with its moment.
  void add_sum(int support, const Vector3& impulse, const Vector3& moment);
  void add(const SupportImpulses& other, double factor = 1);
  std::size_t size() const { return sums_.size(); }
  Vector3 impulse(std::size_t support) const { return sums_[support].impulse; }
  Vector3 moment(std::size_t support) const { return sums_[support].moment; }

 private:
  struct Sum {
    Vector3 impulse{}, moment{};
  };
  std::vector<Sum> sums_;
};

/// A ghost beyond a wall and its mirror before it.
struct MirroredPlaces {
  int support = 0;
  Vector3 ghost{}, mirror{};  ///< m
};

/// What a backend may sum by itself: what nodes are given where they are held, the three that are mirrored and, where
/// particles gather from ghosts, the velocity and its change by the forces.
enum class GivenBySupport { held, mirrored, force, projection, beyond, beyond_increment };

/// The impulses of all supports through the parts of one step.
///  A wall mirrors what lies beyond it: it takes a ghost's momentum away and gives the image to the mirror (`mirror`,
///  `mirror_force`, `mirror_projection`). Particles gather from ghosts again, so the wall takes the mirror's velocity of
///  that mass away and gives the ghost's (`beyond`). Between, nodes are held (`hold`).
///  What was given before the forces is a part of v- and v+ alike: particles that take increments never see it.
class ReactionImpulse {
 public:
  explicit ReactionImpulse(const Experiment& experiment);

  /// Whether anything is to be noted at all.
  bool asked() const { return !record_.empty(); }

  void begin_step();
  /// Adds what a backend has summed of one support instead of noting it node by node.
  void add(GivenBySupport what, int support, const Vector3& impulse, const Vector3& moment);
  /// A node at x is given an impulse, kg m/s.
  void hold(int support, const Vector3& x, const Vector3& impulse) { held_.add(support, x, impulse); }
  /// A ghost's momentum, or force (N), is taken away and its image given to the mirror.
  void mirror(const MirroredPlaces& at, const Vector3& ghost, const Vector3& image) {
    move(mirrored_, at, ghost, image);
  }
  void mirror_force(const MirroredPlaces& at, const Vector3& ghost, const Vector3& image) {
    move(forces_, at, ghost, image);
  }
  /// The velocity v- is complete.
  void keep_before();
  /// The forces have acted over dt, s.
  void apply_forces(double dt);

  /// In a filter's loop a pass gathers the increment, of ghosts too (`beyond_projection`), scatters it as momenta, and
  /// folds these; the plugin then takes `share` of the projection into the velocity.
  void begin_projection() { projected_.clear(); }
  void beyond_projection(const MirroredPlaces& at, const Vector3& of_mirror, const Vector3& of_ghost) {
    move(projected_, at, of_mirror, of_ghost, true);
  }
  void mirror_projection(const MirroredPlaces& at, const Vector3& ghost, const Vector3& image) {
    move(projected_, at, ghost, image);
  }
  void take_projection(int iteration);
  /// Conditions answer to the free velocity anew.
  void take_back() { held_.clear(); }
  /// These follow the velocity of the grid through Act::keep_velocity, restore_velocity and add_correction.
  void keep() { kept_mirrored_ = mirrored_, kept_held_ = held_; }
  void restore(bool keeps_correction);
  void add_correction();

  /// Particles gather from the velocity of now: the momentum that the ghost's own mass has by the mirror's velocity and
  /// by its own, and the same of the velocities' change by the forces.
  void begin_gather();
  void beyond(const MirroredPlaces& at, const Vector3& of_mirror, const Vector3& of_ghost) {
    move(gathered_, at, of_mirror, of_ghost, true);
  }
  void beyond_increment(const MirroredPlaces& at, const Vector3& of_mirror, const Vector3& of_ghost) {
    move(gathered_increment_, at, of_mirror, of_ghost, true);
  }
  /// Makes the record of what particles take when they gather now.
  void record(const StepInfo& step);

  /// Adds what a grip has given its particles after the gather, in a step of dt, s.
  void give_particles(int support, const GivenToGripped& given, double dt);

  const std::vector<Reaction>& reactions() const { return record_; }
  /// Goes on from a saved record, of as many supports.
  void resume(std::vector<Reaction> record) { record_ = std::move(record); }

 private:
  /// Takes `from` away at the ghost and gives `to` at the mirror; the other way round with `outward`.
  static void move(SupportImpulses& sums, const MirroredPlaces& at, const Vector3& from, const Vector3& to,
                   bool outward = false) {
    sums.add(at.support, outward ? at.mirror : at.ghost, from, -1);
    sums.add(at.support, outward ? at.ghost : at.mirror, to);
  }

  const Experiment& experiment_;
  GatherShares shares_;
  SupportImpulses mirrored_, held_, forces_;            ///< forces in N
  SupportImpulses before_, kept_mirrored_, kept_held_;  ///< copies
  SupportImpulses projected_, gathered_, gathered_increment_;
  std::vector<Vector3> impulse_before_;  ///< N s, until the step under way
  std::vector<Reaction> record_;
};

}  // namespace mpm
