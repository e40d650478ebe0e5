#include "backends/device/device_backend.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::momentum_to_velocity(const Pass& pass, const StepInfo& step) {
  begin_stage(accounted_ && !pass.remap());
  conditions_.evaluate(step.time, scene_, on_host_);
  if (heat_conditions_) heat_conditions_->evaluate(step.time, scene_);
  const bool records_heat = plan_.has_heat_ledger() && !pass.remap() && heat_conditions_->walls_act();
  const double heat = records_heat ? sum_over_nodes("heat_of_nodes") : 0.0;
  if (notes_reactions_) reactions_.begin_step();
  fold_momenta({pass.remap()});
  if (!pass.remap()) heat_of_images_ = records_heat ? sum_over_nodes("heat_of_nodes") - heat : 0.0;
  if (!pass.remap()) fold_forces();
  for_each_field("divide", vectors());
  scene_.grips_at_end = pass.remap();
  keep_free_velocity({});
  impose_conditions({});
  if (plan_.resolves_contact()) {
    resolve_contact(step, pass.remap() ? Recorded::nothing : Recorded::before_forces);
    impose_conditions({});
  }
  measure_constraints();
  if (notes_reactions_) reactions_.keep_before();
  if (scene_.records) book_folds(), book_impulses();
  if (!pass.remap()) for_each_field("keep_velocity", vectors());
  for_each_axis("fill_velocities", filled_axes());
}

template <class T>
void DeviceBackend<T>::apply_forces(const StepInfo& step) {
  const Manner after{false, true};
  scene_.grips_at_end = true;
  conditions_.evaluate(step.time + step.dt, scene_, on_host_);
  scene_.records = accounted_;
  fold_forces();  // folds what USF scattered after the momenta were folded
  if (accounted_) book_folds();
  for_each_field("accelerate", nodes());
  begin_stage(accounted_);
  keep_free_velocity(after);
  impose_conditions(after);
  if (plan_.resolves_contact()) {
    resolve_contact(step, Recorded::after_forces);
    impose_conditions(after);
  }
  measure_constraints();
  if (experiment_.damping.acts()) damp(step);
  if (accounted_) account_for_impulses();
  for_each_axis("fill_velocities", filled_axes());
  if (notes_reactions_) reactions_.apply_forces(step.dt);
  record_reactions(step);
}

template <class T>
std::vector<T> DeviceBackend<T>::sum_of_forces(const VelocityField<T>& field) {
  std::vector<T> sum;
  for (int number = 0; number < static_cast<int>(field.arrays.fields().size()); ++number) {
    const Field& force = field.arrays.fields()[number];
    if (force.folded != Folded::with_force || force.at_wall != AtWall::vector) continue;
    const std::vector<T> values = field.arrays.read(number);
    sum.resize(values.size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[k];
  }
  return sum;
}

template <class T>
void DeviceBackend<T>::fold_momenta(const Manner& manner) {
  for (const int axis : walls_) {
    std::vector<std::vector<T>> momenta, masses;
    for (std::size_t k = 0; notes_reactions_ && k < fields_.size(); ++k)
      momenta.push_back(fields_[k].arrays.read("momentum")), masses.push_back(fields_[k].arrays.read("mass"));
    for_each_axis("fold_masses", {axis}, manner);
    for (std::size_t k = 0; k < momenta.size(); ++k) {
      NodesOnHost<T> now(fields_[k]);
      noted_.fold_momenta(static_cast<int>(k), now, axis, std::move(momenta[k]), std::move(masses[k]));
    }
  }
}

template <class T>
void DeviceBackend<T>::fold_forces() {
  for (const int axis : folded_axes()) {
    std::vector<std::vector<T>> forces;
    for (std::size_t k = 0; notes_reactions_ && !periodic(axis) && k < fields_.size(); ++k)
      forces.push_back(sum_of_forces(fields_[k]));
    for_each_axis("fold_forces", {axis});
    for (std::size_t k = 0; k < forces.size(); ++k) {
      NodesOnHost<T> now(fields_[k]);
      noted_.fold_forces(now, axis, std::move(forces[k]));
    }
  }
}

template <class T>
void DeviceBackend<T>::fold_projection(bool at_rest) {
  for (const int axis : folded_axes()) {
    std::vector<std::vector<T>> projections;
    for (std::size_t k = 0; notes_reactions_ && !periodic(axis) && k < fields_.size(); ++k)
      projections.push_back(fields_[k].arrays.read("projection"));
    for_each_axis("fold_projection", {axis}, {false, false, at_rest});
    for (std::size_t k = 0; k < projections.size(); ++k) {
      NodesOnHost<T> now(fields_[k]);
      noted_.fold_projection(static_cast<int>(k), now, axis, std::move(projections[k]), at_rest);
    }
  }
}

template <class T>
void DeviceBackend<T>::impose_conditions(const Manner& manner) {
  for (std::size_t k = 0; notes_reactions_ && k < fields_.size(); ++k) {
    NodesOnHost<T> now(fields_[k]);
    noted_.hold(now, conditions_.supports(), scene_.grips_at_end);
  }
  for_each_field("impose_conditions", nodes(), manner);
}

template <class T>
void DeviceBackend<T>::note_gathered_increment() {
  if (!notes_reactions_) return;
  reactions_.begin_projection();
  std::vector<NodesOnHost<T>> now(fields_.begin(), fields_.end());
  for (const int axis : walls_)
    for (std::size_t k = 0; k < now.size(); ++k) noted_.gather_increment(static_cast<int>(k), now[k], axis);
}

template <class T>
void DeviceBackend<T>::record_reactions(const StepInfo& step) {
  if (!notes_reactions_) return;
  reactions_.begin_gather();
  std::vector<NodesOnHost<T>> now(fields_.begin(), fields_.end());
  for (const int axis : walls_)
    for (std::size_t k = 0; k < now.size(); ++k) noted_.gather(static_cast<int>(k), now[k], axis);
  reactions_.record(step);
}

template <class T>
void DeviceBackend<T>::damp(const StepInfo& step) {
  const Damping& damping = experiment_.damping;
  const Manner after{false, true};
  scene_.local_damping = static_cast<T>(damping.local);
  scene_.left_of_velocity = static_cast<T>(damping.left_of_velocity(step.dt));
  scene_.left_of_change = static_cast<T>(damping.left_of_change(step.dt));
  for_each_field("damp", vectors());
  keep_free_velocity(after);
  impose_conditions(after);
  measure_constraints();
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
