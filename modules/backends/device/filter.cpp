#include "backends/device/device_backend.hpp"

#include <cmath>
#include <limits>

#include "backends/device/kernels/reactions.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::measure_increment(const std::function<void(double)>& use) {
  const Tally<1> square = sum_over_nodes("increment_norm");
  later([square, use] { use(std::sqrt((*square)[0])); });
  if (experiment_.filter_schedule.tolerance > 0) look();
}

template <class T>
void DeviceBackend<T>::keep_unfiltered() {
  for_each_field("keep_unfiltered", vectors());
  later([this] { contact_impulse_.keep(); });
  later([this] { reactions_.keep(); });
}

template <class T>
void DeviceBackend<T>::begin_filter(const Pass& pass) {
  for_each_field("begin_filter", vectors());
  if (pass.has(Act::keep_velocity)) keep_unfiltered();
  filter_pass_ = 0;
  measure_increment([this](double norm) { filter_.iterations = 0, filter_.first_norm = filter_.last_norm = norm; });
  begin_stage(accounted_ && pass.stage == Stage::after_forces);
}

template <class T>
void DeviceBackend<T>::project(const Pass& pass, const StepInfo& step) {
  conditions_.evaluate(time_of(pass, step), scene_);
  for_each_field("clear_projection", vectors());
  for (Body<T>& body : bodies_) run_blocks("project", arguments_of(body), body);
  if (notes_reactions_) {
    later([this] { reactions_.begin_projection(); });
    note_beyond(beyond_increment, GivenBySupport::projection);
  }
  fold_projection(filter_pass_ > 0);
}

template <class T>
void DeviceBackend<T>::update_filter(const Pass& pass, const StepInfo& step) {
  for_each_field("update_filter", nodes());
  if (notes_reactions_) later([this, pass = filter_pass_ + 1] { reactions_.take_projection(pass); });
  if (experiment_.filter_schedule.constrain_always) {
    constrain_velocity(pass, step);
    for_each_field("correct_increment", vectors());
  }
  ++filter_pass_;
  measure_increment([this](double norm) {
    filter_.take_norm(norm, 4500.0 * static_cast<double>(std::numeric_limits<T>::epsilon()));
  });
  for_each_axis("fill_increments", filled_axes());
}

template <class T>
void DeviceBackend<T>::keep_free_velocity(const Manner& manner) {
  if (plan_.node_field("velocity_of_constraints")) for_each_field("keep_free_velocity", vectors(), manner);
}

template <class T>
void DeviceBackend<T>::measure_constraints() {
  if (plan_.node_field("velocity_of_constraints")) for_each_field("measure_constraints", vectors());
}

template <class T>
void DeviceBackend<T>::constrain_velocity(const Pass& pass, const StepInfo& step) {
  conditions_.evaluate(time_of(pass, step), scene_);
  if (plan_.node_field("velocity_of_constraints")) {
    for_each_field("take_free_velocity", vectors());
    if (notes_reactions_) later([this] { reactions_.take_back(); });
  }
  impose_conditions({});
  if (plan_.resolves_contact()) {
    resolve_contact(step, pass.remap() ? Recorded::nothing : Recorded::filter, pass.stage, time_of(pass, step));
    if (pass.stage == Stage::after_forces) record_force(step);
    impose_conditions({});
  }
  measure_constraints();
}

template <class T>
void DeviceBackend<T>::restore_velocity(const Pass& pass) {
  const bool keeps = pass.has(Act::keep_correction);
  if (accounted_ && !keeps) {
    const Tally<1> power = sum_over_nodes("power_of_filter");
    later([this, power, share = early_share_] { ledger_.filtered_strain -= share * (*power)[0]; });
  }
  later([this, keeps] { contact_impulse_.restore(keeps); });
  later([this, keeps] { reactions_.restore(keeps); });
  for_each_field(keeps ? "keep_correction" : "restore_velocity", vectors());
}

template <class T>
void DeviceBackend<T>::end_filter(const Pass& pass, const StepInfo& step) {
  conditions_.evaluate(time_of(pass, step), scene_);
  if (!experiment_.filter_schedule.constrain_always) constrain_velocity(pass, step);
  for_each_axis("fill_velocities", filled_axes());
  if (scene_.records) book_filter();
  if (pass.stage == Stage::after_forces) record_reactions(step);
}

template <class T>
void DeviceBackend<T>::add_correction(const Pass& pass, const StepInfo& step) {
  begin_stage(accounted_);
  for_each_field("add_correction", vectors());
  later([this] { contact_impulse_.add_correction(); });
  later([this] { reactions_.add_correction(); });
  constrain_velocity(pass, step);
  for_each_axis("fill_velocities", filled_axes());
  if (accounted_) book_filter();
  record_reactions(step);
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
