#pragma once
// Counts the momentum that contact hands over in a step, so that the recorded force is that which particles feel, and
// the heat of its friction.

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "experiment/experiment.hpp"
#include "operators/contact.hpp"
#include "simulation/backend.hpp"

namespace mpm {

static_assert(static_cast<int>(MPM_APART) == contact_apart && static_cast<int>(MPM_STICKS) == contact_sticks &&
              static_cast<int>(MPM_SLIPS) == contact_slips);

/// The shares of the grid's velocity and of its increment in the velocity that a gather gives a particle,
/// v <- ... + of_velocity sum w v+ + of_increment sum w (v+ - v-): 1 and 0 for APIC, 0 and 1 for FLIP.
struct GatherShares {
  double of_velocity = 1, of_increment = 0;
};
/// Asks the scene's transfer for them, with a particle at rest whose state is zero.
GatherShares gather_shares(const Experiment& experiment);

/// The place of the pair (a, b), a < b, among those of so many fields: (0, 1), (0, 2), ..., (1, 2), ...
constexpr std::size_t pair_index(int a, int b, int fields) {
  return static_cast<std::size_t>(a * (2 * fields - a - 1) / 2 + b - a - 1);
}

/// The pairs that are recorded apart: none unless the experiment asks.
inline std::size_t recorded_pairs(const Experiment& experiment) {
  const auto fields = static_cast<std::size_t>(experiment.field_count);
  return experiment.contact && experiment.output.contact_pairs ? fields * (fields - 1) / 2 : 0;
}

/// The sums of what contact does to one pair at one occasion, over the nodes where it meets.
struct PairGiven {
  Vector3 impulse{};                ///< on the first body, kg m/s
  Vector3 along{};                  ///< the parts of it along the nodes' normals, kg m/s
  double pressing = 0;              ///< sum of their sizes, positive where they push the bodies apart, kg m/s
  long sticking = 0, slipping = 0;  ///< nodes
  Vector3 unbalanced{};             ///< what both bodies gain together, kg m/s: rounding, but with own normals
  double largest_penetration = 0;   ///< m
  double largest_gap = 0;           ///< m, that was open where the law acted
  double area = 0;                  ///< m^2 (m in 2-D), where the fields touch

  /// Takes what the law did at a node; a weld acts where there is no normal too.
  void count(std::int32_t status, double separation, double area_of_node, bool has_normal) {
    sticking += status == MPM_STICKS;
    slipping += status == MPM_SLIPS;
    if (status == MPM_APART || !has_normal) return;
    largest_penetration = std::max(largest_penetration, -separation);
    largest_gap = std::max(largest_gap, separation);
    area += area_of_node;
  }
  void add(const PairGiven& other) {
    for (std::size_t c = 0; c < 3; ++c) {
      impulse[c] += other.impulse[c], along[c] += other.along[c];
      unbalanced[c] += other.unbalanced[c];
    }
    pressing += other.pressing;
    sticking += other.sticking, slipping += other.slipping;
    largest_penetration = std::max(largest_penetration, other.largest_penetration);
    largest_gap = std::max(largest_gap, other.largest_gap);
    area += other.area;
  }
};

/// What contact does at one node at one occasion.
struct NodeGiven {
  ContactNode node;
  Vector3 impulse{};  ///< on the first body, kg m/s
};

/// The sums of what contact does to all pairs at one occasion.
struct ContactGiven {
  Vector3 impulse{};               ///< on the first bodies, kg m/s
  double dissipated = 0;           ///< J, as the law says
  std::vector<PairGiven> pairs{};  ///< each of them, where pairs are recorded
  std::vector<NodeGiven> nodes{};  ///< each of them in one order in all stages of the step, where nodes are recorded
  double driven = 0;               ///< J, work of rigid bodies, by their own velocities
  double stored = 0;               ///< J, taken up by the springs of the law
};

/// Whether a run records the nodes where fields meet, and whether it does in this step.
inline bool records_nodes(const Experiment& experiment) {
  const bool for_particles = experiment.particle_output && experiment.particle_output->asks("contact_traction");
  return experiment.contact && (experiment.output.contact_nodes || experiment.output.normal_error || for_particles);
}
inline bool records_nodes(const Experiment& experiment, const StepInfo& step) {
  return step.observed && records_nodes(experiment);
}

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
  void keep();
  void restore(bool keeps_correction);
  void add_correction();

  /// The momentum that particles take from contact when they gather now.
  Vector3 handed_over(bool filtered) const {
    const Momentum total = handed_over(total_, filtered);
    return {total[0], total[1], total[2]};
  }
  /// Records of each recorded pair and node: where they meet after the forces, and the force by what particles take now,
  /// over a step of dt, which is added to the impulse of the run.
  void record_counts(const ContactGiven& given);
  void record_forces(bool filtered, double dt);
  /// The records of the pairs; empty where the experiment does not ask for them. They go into checkpoints.
  std::vector<PairRecord>& pairs() { return records_; }
  const std::vector<PairRecord>& pairs() const { return records_; }
  /// The records of the nodes of the last step; empty where it was not to be recorded.
  const std::vector<ContactNode>& nodes() const { return nodes_; }

 private:
  /// What the step hands on of a pair, kg m/s: its impulse, its normal part, how hard that presses and what is unbalanced
  /// (PairGiven).
  using Momentum = std::array<double, 10>;
  static Momentum momentum_of(const PairGiven& given);
  /// A momentum on its way through the step.
  struct Flow {
    Momentum before{}, now{}, kept{};
  };
  /// Visits the flow of all pairs together and that of each recorded pair and node, with what was given to it.
  template <class Visit>
  void for_each_flow(const ContactGiven& given, Visit visit);
  template <class Visit>
  void for_each_flow(Visit visit);
  Momentum handed_over(const Flow& flow, bool filtered) const;

  GatherShares shares_;
  Flow total_;
  std::vector<Flow> flows_;       ///< one a recorded pair
  std::vector<Flow> node_flows_;  ///< one a recorded node
  std::vector<PairRecord> records_;
  std::vector<PairRecord>
      before_step_;  ///< its impulses are those until the step under way, whose force may change yet
  std::vector<ContactNode> nodes_;
  /// Books heat and the work of rigid bodies, which is taken out of contact's own row; with -1 takes them back.
  static void book(Ledger& ledger, const ContactGiven& given, double share);

  double friction_ = 0, kept_friction_ = 0;  ///< J, of all that contact has done in the step
  double driven_ = 0, kept_driven_ = 0;      ///< J, work of rigid bodies in the step
  double stored_ = 0, kept_stored_ = 0;      ///< J, taken up by springs in the step
};

}  // namespace mpm
