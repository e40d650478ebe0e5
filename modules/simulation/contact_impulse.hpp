#pragma once
// Counts the momentum that contact hands over in a step, so that the recorded force is that which particles feel, and
// the heat of its friction.

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

/// The sums of what contact does to all pairs at one occasion.
struct ContactGiven {
  Vector3 impulse{};      ///< on the first bodies, kg m/s
  double dissipated = 0;  ///< J, as the law says
};

/// The impulses of contact on the first bodies of all pairs through the parts of one step, and the heat of friction.
/// What contact does before the forces is a part of v- and v+ alike: particles that take increments never see it. The
/// heat is booked where a ledger is given.
class ContactImpulse {
 public:
  explicit ContactImpulse(const Experiment& experiment);

  /// Books the heat in two shares: what particles keep, and what their gather takes back, since they add increments
  /// alone to velocities of their own.
  void before_forces(const ContactGiven& given, bool filtered, Ledger* ledger);
  void after_forces(const ContactGiven& given, Ledger* ledger);
  /// In a filter's loop, where contact answers to the whole velocity again (`replaces`) or to what is left of it.
  void in_filter(const ContactGiven& given, bool replaces, Ledger* ledger);
  /// These follow the velocity of the grid through Act::keep_velocity, restore_velocity and add_correction.
  void keep() { kept_ = now_, kept_friction_ = friction_; }
  void restore(bool keeps_correction);
  void add_correction() { add(kept_); }

  /// The momentum that particles take from contact when they gather now.
  Vector3 handed_over(bool filtered) const;

 private:
  void add(const Vector3& impulse);

  GatherShares shares_;
  Vector3 before_{}, now_{}, kept_{};
  double friction_ = 0, kept_friction_ = 0;  ///< J, of all that contact has done in the step
};

}  // namespace mpm
