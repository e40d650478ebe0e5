#include "backends/device/device_backend.hpp"

#include <stdexcept>

namespace mpm::device {

/// Passes wait for the end of their step, by which it is known whether a graph does all of them at once. What the host
/// decides by, the estimate of the step and the norms of a filter's loop with a tolerance, does not wait.
template <class T>
void DeviceBackend<T>::execute(const Pass& pass, const StepInfo& step) {
  time_ = step.time, end_ = step.time + step.dt;
  formulas_.take(time_, end_);  // before the launches of the step, and outside of its graph
  const bool by_norm = step.filtered && experiment_.filter_schedule.tolerance > 0;
  const bool decides = pass.has(Act::estimate_time_step) || by_norm;
  if (uses_graphs_ && !decides && !device_->measures()) {
    waiting_.push_back({&pass, step});
  } else {
    perform(waiting_);
    waiting_.clear();
    perform(pass, step);
  }
  if (pass.name() == last_pass_) end_step();
}

template <class T>
void DeviceBackend<T>::end_step() {
  std::vector<WaitingPass> passes;
  passes.swap(waiting_);
  if (passes.empty()) return look();
  KnownStep& known = graphs_.of(kind_of(passes));
  if (known.graph || known.alone) {
    if (!known.graph) capture(known, passes);
    device_->launch(known.graph);
    results_.take_up(known.uses, known.used), watched_ = known.watched;
    prepared_ = known.prepares;
  } else {
    const long copies = device_->host_copies();
    perform(passes);
    known.alone = device_->host_copies() == copies;
  }
  look();
}

template <class T>
StepKind DeviceBackend<T>::kind_of(const std::vector<WaitingPass>& passes) const {
  StepKind kind;
  for (const WaitingPass& waiting : passes) kind.passes.push_back(waiting.pass);
  const StepInfo& step = passes.back().step;
  kind.dt = step.dt, kind.filtered = step.filtered, kind.accounted = plan_.accounts_at(step.step);
  kind.notes_contact = records_nodes(experiment_, step);
  kind.first_of_state = step.step == 0 && !experiment_.contact_state().empty();
  kind.gravity = experiment_.gravity_at(step.time);
  kind.prepared = prepared_, kind.forgets = forgets_grid(step.step);
  return kind;
}

template <class T>
void DeviceBackend<T>::capture(KnownStep& known, const std::vector<WaitingPass>& passes) {
  device_->begin_capture();
  try {
    perform(passes);
    known.graph = device_->end_capture();
  } catch (...) {
    device_->abandon_capture();
    throw;
  }
  known.uses = results_.uses(), known.used = results_.used();
  known.watched.swap(watched_);
  known.prepares = prepared_;
  launches_ = 0;
}

template <class T>
void DeviceBackend<T>::perform(const std::vector<WaitingPass>& passes) {
  for (const WaitingPass& waiting : passes) perform(*waiting.pass, waiting.step);
}

template <class T>
void DeviceBackend<T>::perform(const Pass& pass, const StepInfo& step) {
  scene_.dt = static_cast<T>(step.dt);
  accounted_ = plan_.accounts_at(step.step);
  notes_reactions_ = reactions_.asked() && !pass.remap();
  switch (pass.operators.front().act) {
    case Act::estimate_time_step:
      return estimate_time_step();
    case Act::sort:
    case Act::sort_ahead:
      return;  // the scatter sorts
    case Act::clear:
      return clear(step);
    case Act::scatter_momentum:
    case Act::scatter_force:
      return scatter(pass, step);
    case Act::divide:
      return momentum_to_velocity(pass, step);
    case Act::accelerate:
      return apply_forces(step);
    case Act::keep_contact_state:
      return keep_contact_state();
    case Act::gather:
      return gather(pass, step);
    case Act::strain:
      return strain(pass);
    case Act::move:
      return move();
    case Act::begin_filter:
      return begin_filter(pass);
    case Act::project:
      return project(pass, step);
    case Act::update_filter:
      return update_filter(pass, step);
    case Act::end_filter:
      return end_filter(pass, step);
    case Act::divide_heat:
      return heat_to_temperature();
    case Act::conduct:
      return conduct();
    case Act::heat:
      return warm(step);
    case Act::scatter_mean_stress:
      return scatter_mean_stress();
    case Act::average_mean_stress:
      return average("mean_stress");
    case Act::scatter_dilation:
      return scatter_dilation(pass);
    case Act::average_dilation:
      return average("dilation");
    case Act::change_phase:
      return change_phase();
    case Act::restore_velocity:
      return restore_velocity(pass);
    case Act::add_correction:
      return add_correction(pass, step);
    default:  // the other acts share a visit with one of these
      throw std::logic_error("the device does not execute pass \"" + pass.name() + "\"");
  }
}

template <class T>
void DeviceBackend<T>::clear(const StepInfo& step) {
  if (!forgets_grid(step.step)) return for_each_field("clear", nodes());
  for_each_field("forget", nodes());
  for (VelocityField<T>& field : fields_) field.active.clear();
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
