#pragma once
// Counts the momentum that contact hands over in a step, so that the recorded force is that which particles feel.

#include "experiment/experiment.hpp"
#include "simulation/backend.hpp"

namespace mpm {

/// The shares of the grid's velocity and of its increment in the velocity that a gather gives a particle,
/// v <- ... + of_velocity sum w v+ + of_increment sum w (v+ - v-): 1 and 0 for APIC, 0 and 1 for FLIP.
struct GatherShares {
  double of_velocity = 1, of_increment = 0;
};
/// Asks the scene's transfer for them, with a particle at rest whose state is zero.
GatherShares gather_shares(const Experiment& experiment);

/// The impulses of contact on the first bodies of all pairs, kg m/s, through the parts of one step. What contact does
/// before the forces is a part of v- and v+ alike: particles that take increments never see it.
class ContactImpulse {
 public:
  explicit ContactImpulse(const Experiment& experiment);

  void before_forces(const Vector3& impulse) { before_ = now_ = impulse; }
  void after_forces(const Vector3& impulse) { add(impulse); }
  /// In a filter's loop, where contact answers to the whole velocity again (`replaces`) or to what is left of it.
  void in_filter(const Vector3& impulse, bool replaces) {
    if (replaces) now_ = {};
    add(impulse);
  }
  /// These follow the velocity of the grid through Act::keep_velocity, restore_velocity and add_correction.
  void keep() { kept_ = now_; }
  void restore(bool keeps_correction);
  void add_correction() { add(kept_); }

  /// Books the heat of friction before the forces: the share of it that particles keep, and that which their gather
  /// takes back, since they add increments alone to velocities of their own.
  void account_before_forces(double dissipated, bool filtered, Ledger& ledger) const;

  /// The momentum that particles take from contact when they gather now.
  Vector3 handed_over(bool filtered) const;

 private:
  void add(const Vector3& impulse);

  GatherShares shares_;
  Vector3 before_{}, now_{}, kept_{};
};

}  // namespace mpm
