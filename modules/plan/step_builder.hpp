#pragma once
// What a solver writes its step with: operators one after another, under conditions and in loops.

#include <functional>

#include "plan/plan.hpp"

namespace mpm {

/// A pass of one operator.
Step single(Act act, const std::string& because, int every_steps = 1);

class StepBuilder {
 public:
  explicit StepBuilder(const Experiment& experiment) : experiment_(experiment) { root_.kind = Step::Kind::sequence; }

  const Experiment& experiment() const { return experiment_; }
  /// A component as reasons name it: its JSON pointer and its id.
  static std::string named(const Component& component);

  /// Appends an operator in a pass of its own; returns the pass, for its share and cadence. Passes that one visit can do
  /// are joined later (join_visits).
  Pass& perform(Act act, const std::string& because, Stage stage = Stage::before_forces);
  /// Appends what `build` performs, executed under a condition.
  void when(Condition condition, const std::string& because, const std::function<void()>& build);
  /// Appends what `build` performs, executed up to `times` times, until the filter's increment is small enough.
  void repeat_until_small(int times, const std::string& because, const std::function<void()>& build);

  Step take() { return std::move(root_); }

 private:
  void nested(Step step, const std::function<void()>& build);

  const Experiment& experiment_;
  Step root_;
  std::vector<Step*> open_{&root_};
};

/// The parts of a step that a filter adds, wherever the solver has a velocity for it; nothing without a filter. A
/// filter before the forces (XPIC) acts on v- for the particles alone, one after the forces (FMPM) on v+ for strains too.
class FilterParts {
 public:
  explicit FilterParts(StepBuilder& step);

  /// Filtered v- serves the particles alone: forces and strains take the unfiltered velocity.
  bool for_particles_only() const { return filter_ && before_forces_; }
  /// After v-: the loop, and the velocity kept aside where something still needs it. `strains`: the solver strains next.
  void before_forces(bool strains);
  /// Before the forces: the unfiltered velocity again, where the loop has filtered it for a strain.
  void unfilter_for_forces(bool strained);
  /// After v+.
  void after_forces();
  /// Before the gather: what the particles take.
  void before_gather();
  /// After the remapped velocity of MUSL.
  void remapped();

 private:
  void loop(Stage stage, bool keeps_velocity);
  std::string name() const { return StepBuilder::named(*filter_); }

  StepBuilder& step_;
  const Component* filter_ = nullptr;
  bool before_forces_ = false;
};

/// Who asked, of a reason: what stands before its explanation.
inline std::string asker(const std::string& because) {
  return because.substr(0, because.find(": "));
}

/// The plan of an experiment whose solver writes its step by `solver_step`. Throws InputError (see make_plan).
Plan assemble_plan(const Experiment& experiment, const std::function<void(StepBuilder&)>& solver_step);

/// Fills in what each operator of a step reads, writes and adds to, of the fields that the plan holds.
void describe_operators(Plan& plan, const Experiment& experiment);

/// Throws std::logic_error where a step reads what nothing has written, or holds what nobody reads: a fault of a solver
/// or component, named with the operator and the field.
void check_step(const Plan& plan);

/// Puts operators that one visit can do into one pass.
void join_visits(Step& step);
/// Why the gather of a step may not scatter for the next one as well, naming who asked; empty where it may.
std::string why_not_fused(const Step& step, const Experiment& experiment);
/// Whether one launch of a device may take particles from one scatter to the next.
Advance advance_of(const Plan& plan, const Experiment& experiment);
/// Lets the gather of a step scatter for the next one; the step then begins with a scatter only where that was not done.
void fuse(Step& step);

}  // namespace mpm
