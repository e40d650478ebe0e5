#pragma once
// A step as a tree: sequences, conditions and loops over operators. An operator says what it reads, writes and adds to
// and where it runs; what order allows, what may share a visit and what a picture shows follow from that.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mpm {

enum class Act {
  estimate_time_step,   ///< wave and particle speeds -> dt, the limiting particle named
  sort,                 ///< particles into blocks of cells, when they have moved
  sort_ahead,           ///< the same between scatter and gather, for where the move that follows leads
  clear,                ///< what is summed on nodes to zero
  scatter_momentum,     ///< particles -> mass and momentum of nodes
  scatter_force,        ///< particles -> forces of nodes (into the momentum, times dt, where they have no field)
  scatter_contact,      ///< particles -> volume, its gradient and the place of the surface
  scatter_heat,         ///< particles -> heat and heat capacity of nodes
  divide,               ///< fold walls and periodic images, v- = p / m, conditions, contact before the forces
  accelerate,           ///< p+ = p + dt f with conditions, contact after the forces, v+
  divide_heat,          ///< fold, temperature before = heat / capacity, fixed temperatures
  conduct,              ///< on particles: gradient of the temperature -> heat flux -> rates of nodes
  heat,                 ///< temperature after: rates, walls' flux and convection, heating of boxes, fixed temperatures
  begin_filter,         ///< increment <- grid velocity
  keep_velocity,        ///< and the grid velocity is kept aside
  project,              ///< projection <- S+ S increment, by the transfer's own gather and scatter
  update_filter,        ///< the plugin's update at every node; conditions and contact; the increment's mass norm
  end_filter,           ///< constraints where they act at the end only; the ledger's entry; ghosts
  restore_velocity,     ///< grid velocity <- what was kept aside
  keep_correction,      ///< and what the filter had added is kept aside instead
  add_correction,       ///< grid velocity += the correction kept aside; conditions and contact
  keep_contact_state,   ///< on particles: what the contact law says that pairs have reached -> its state
  gather,               ///< grid -> particle velocity and the transfer's state
  gather_heat,          ///< grid -> particle temperature and the transfer's state for it
  scatter_mean_stress,  ///< on particles: stress -> mean normal stress; its sum by volume -> nodes
  average_mean_stress,  ///< fold, average = sum by volume / volume
  scatter_dilation,     ///< on particles: velocity gradient -> dilation; its sum by volume -> nodes
  average_dilation,     ///< fold, average = sum by volume / volume
  strain,               ///< grid velocity -> velocity gradient -> material state
  move,                 ///< x += dt times the advection velocity of the gather
  change_phase          ///< heat beyond the melting temperature becomes latent, and back
};
inline constexpr int act_count = static_cast<int>(Act::change_phase) + 1;

/// What an operator visits, one after another.
enum class Where { particles, nodes };

/// Which velocity of the step: v- before the forces, v+ after them, or the one that MUSL maps back from the particles.
enum class Stage { before_forces, after_forces, remapped };

/// Values that an operator uses, as "particles/position" or "nodes/momentum".
using FieldNames = std::vector<std::string>;

struct Operator {
  Act act = Act::clear;
  Where where = Where::nodes;
  FieldNames reads, writes, adds;
  std::string because;  ///< JSON pointer of what asked for it, and why
};

/// Operators that one visit of every particle or node does, one after another.
struct Pass {
  std::vector<Operator> operators;
  std::uint32_t acts = 0;  ///< bit of each operator's act, see `has`
  Stage stage = Stage::before_forces;
  double share = 1;     ///< how much of the step a strain takes
  int every_steps = 1;  ///< is executed in steps 0, every_steps, 2 every_steps ...

  bool has(Act act) const { return (acts >> static_cast<int>(act) & 1) != 0; }
  /// A visit that gathers and scatters for the next step.
  bool fused() const { return has(Act::gather) && has(Act::scatter_momentum); }
  bool remap() const { return stage == Stage::remapped; }
  /// The second strain of a step that strains twice.
  bool second_half() const { return stage == Stage::after_forces && share < 1; }
  /// What a fused visit does for the step itself, without what it does for the next one.
  Pass before_next_step() const;
  void add(Operator operation) {
    acts |= 1u << static_cast<int>(operation.act);
    operators.push_back(std::move(operation));
  }
  /// What a person calls it; times of a run are summed by it.
  std::string name() const;
};

enum class Condition {
  unless_scattered,  ///< the step before has not left this step's sums on the nodes
  when_filtered,     ///< the filter's schedule says that it acts in this step
  may_scatter_ahead  ///< the next step's dt is known: the second child is executed instead where it is not
};

/// A node of the tree.
struct Step {
  enum class Kind { pass, sequence, when, repeat_until };
  Kind kind = Kind::sequence;
  Pass pass;                                          ///< what a `pass` does
  Condition condition = Condition::unless_scattered;  ///< when a `when` does
  int times = 0;        ///< how often a `repeat_until` does at most; it ends when |increment| <= tolerance |first|
  std::string because;  ///< why there is a `when` or a `repeat_until`
  std::vector<Step> children;

  std::string name() const;
};

/// Calls visit(pass) for every pass of a tree, in order.
template <class Tree, class Visit>
void for_each_pass(Tree& step, Visit&& visit) {
  if (step.kind == Step::Kind::pass) visit(step.pass);
  for (auto& child : step.children) for_each_pass(child, visit);
}

/// The same without the gather that stands in for a fused one in some steps.
template <class Visit>
void for_each_pass_as_a_rule(const Step& step, Visit&& visit) {
  if (step.kind == Step::Kind::pass) return visit(step.pass);
  const bool either = step.kind == Step::Kind::when && step.condition == Condition::may_scatter_ahead;
  for (const Step& child : step.children) {
    for_each_pass_as_a_rule(child, visit);
    if (either) return;
  }
}

}  // namespace mpm
