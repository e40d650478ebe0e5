#include "plan/step_builder.hpp"

#include "experiment/diagnostics.hpp"

namespace mpm {

std::string StepBuilder::named(const Component& component) {
  return component.pointer + " \"" + std::string(component.plugin->id()) + "\"";
}

Step single(Act act, const std::string& because, int every_steps) {
  Step step;
  step.kind = Step::Kind::pass;
  step.pass.every_steps = every_steps;
  Operator operation;
  operation.act = act;
  operation.because = because;
  step.pass.add(std::move(operation));
  return step;
}

Pass& StepBuilder::perform(Act act, const std::string& because, Stage stage) {
  Pass& pass = open_.back()->children.emplace_back(single(act, because)).pass;
  pass.stage = stage;
  return pass;
}

void StepBuilder::nested(Step step, const std::function<void()>& build) {
  open_.push_back(&step);
  build();
  open_.pop_back();
  open_.back()->children.push_back(std::move(step));
}

void StepBuilder::when(Condition condition, const std::string& because, const std::function<void()>& build) {
  Step step;
  step.kind = Step::Kind::when;
  step.condition = condition;
  step.because = because;
  nested(std::move(step), build);
}

void StepBuilder::repeat_until_small(int times, const std::string& because, const std::function<void()>& build) {
  Step step;
  step.kind = Step::Kind::repeat_until;
  step.times = times;
  step.because = because;
  nested(std::move(step), build);
}

// ---- the filter's parts --------------------------------------------------------------------------------------------

FilterParts::FilterParts(StepBuilder& step) : step_(step) {
  if (!step.experiment().filter) return;
  filter_ = &*step.experiment().filter;
  before_forces_ = (filter_->plugin->filter().traits & MPM_FILTERS_BEFORE_FORCES) != 0;
}

void FilterParts::loop(Stage stage, bool keeps_velocity) {
  const mpm_filter& functions = filter_->plugin->filter();
  const int times = functions.iterations(filter_->parameters.data());
  if (times < 0)
    throw InputError({{step_.experiment().file.string(), 0, 0, filter_->pointer,
                       "the filter asks for " + std::to_string(times) + " passes"}});
  const bool at_end = !step_.experiment().filter_schedule.constrain_always;
  step_.when(Condition::when_filtered, name(), [&] {
    step_.perform(
        Act::begin_filter,
        name() + (stage == Stage::after_forces ? ": velocity after the forces" : ": velocity before the forces"),
        stage);
    if (keeps_velocity)
      step_.perform(Act::keep_velocity,
                    name() + (before_forces_ ? ": strains; then the correction of the particles"
                                             : ": the strain comes before the forces"),
                    stage);
    if (times > 0)
      step_.repeat_until_small(times, name() + ": passes of its loop", [&] {
        step_.perform(Act::project,
                      StepBuilder::named(step_.experiment().transfer) + ": gathers and scatters the increment", stage);
        step_.perform(Act::update_filter,
                      at_end ? filter_->pointer + "/constraints \"at_end\""
                             : name() + ": conditions and contact act on every increment",
                      stage);
      });
    step_.perform(Act::end_filter, name(), stage);
  });
}

void FilterParts::before_forces(bool strains) {
  if (!filter_ || !(before_forces_ || strains)) return;
  loop(Stage::before_forces, true);
  if (!before_forces_) return;
  step_.when(Condition::when_filtered, name() + ": forces and strain take what was not filtered", [&] {
    const std::string because = name() + ": forces and strain take what was not filtered";
    step_.perform(Act::restore_velocity, because);
    step_.perform(Act::keep_correction, because);
  });
}

void FilterParts::unfilter_for_forces(bool strained) {
  if (!filter_ || before_forces_ || !strained) return;
  const std::string because = name() + ": filters once more after the forces";
  step_.when(Condition::when_filtered, because, [&] { step_.perform(Act::restore_velocity, because); });
}

void FilterParts::after_forces() {
  if (filter_ && !before_forces_) loop(Stage::after_forces, false);
}

void FilterParts::before_gather() {
  if (!for_particles_only()) return;
  const std::string because = name() + ": what the particles take";
  step_.when(Condition::when_filtered, because,
             [&] { step_.perform(Act::add_correction, because, Stage::after_forces); });
}

void FilterParts::remapped() {
  if (filter_ && !before_forces_) loop(Stage::remapped, false);
}

}  // namespace mpm
