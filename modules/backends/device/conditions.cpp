#include "backends/device/device_backend.hpp"
#include "backends/device/kernels/reactions.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::momentum_to_velocity(const Pass& pass, const StepInfo& step) {
  begin_stage(accounted_ && !pass.remap());
  conditions_.evaluate(step.time, scene_);
  if (heat_conditions_) heat_conditions_->evaluate(step.time, scene_);
  const bool records_heat = plan_.has_heat_ledger() && !pass.remap() && heat_conditions_->walls_act();
  const Tally<1> heat = records_heat ? sum_over_nodes("heat_of_nodes") : nullptr;
  if (notes_reactions_) later([this] { reactions_.begin_step(); });
  if (!pass.remap()) rigid_.begin_step();
  fold_momenta({pass.remap()});
  if (records_heat) {
    const Tally<1> folded = sum_over_nodes("heat_of_nodes");
    later([this, heat, folded] { heat_of_images_ = (*folded)[0] - (*heat)[0]; });
  }
  if (!pass.remap()) fold_forces();
  if (merges_ && !pass.remap()) return;  // velocities are made of the momenta when these have their forces
  for_each_field("divide", vectors());
  scene_.grips_at_end = pass.remap();
  keep_free_velocity({});
  impose_conditions({});
  if (plan_.resolves_contact()) {
    resolve_contact(step, pass.remap() ? Recorded::nothing : Recorded::before_forces, Stage::before_forces, step.time);
    impose_conditions({});
  }
  measure_constraints();
  if (notes_reactions_) later([this] { reactions_.keep_before(); });
  if (scene_.records) book_folds(), book_impulses();
  if (!pass.remap() && plan_.node_field("velocity_before")) for_each_field("keep_velocity", vectors());
  for_each_axis("fill_velocities", filled_axes());
}

template <class T>
void DeviceBackend<T>::apply_forces(const StepInfo& step) {
  const Manner after{false, true};
  scene_.grips_at_end = true;
  conditions_.evaluate(step.time + step.dt, scene_);
  scene_.records = accounted_;
  if (merges_) {
    for_each_field("divide", vectors());
  } else {
    fold_forces();  // folds what USF scattered after the momenta were folded
    if (accounted_) book_folds();
    for_each_field("accelerate", nodes());
  }
  begin_stage(accounted_);
  keep_free_velocity(after);
  impose_conditions(after);
  if (plan_.resolves_contact()) {
    resolve_contact(step, Recorded::after_forces, Stage::after_forces, step.time + step.dt);
    impose_conditions(after);
  }
  measure_constraints();
  if (experiment_.damping.acts()) damp(step);
  if (accounted_) account_for_impulses();
  for_each_axis("fill_velocities", filled_axes());
  if (notes_reactions_) later([this, dt = step.dt] { reactions_.apply_forces(dt); });
  record_reactions(step);
  rigid_.bodies().end_step(step);
}

template <class T>
void DeviceBackend<T>::note_walls(const std::string& phase, const Arguments<T>& a, GivenBySupport given) {
  const std::size_t at = place(wall_sums);
  join(phase, a, lines_along(a.axis), wall_sums, at);
  results_.later([this, at, given, axis = a.axis](const double* sums) {
    for (int side = 0; side < 2; ++side)
      take_support(sums + at + support_sums * side, given, support_of_wall(axis, side));
  });
}

template <class T>
void DeviceBackend<T>::take_support(const double* sums, GivenBySupport given, int support) {
  reactions_.add(given, support, {sums[0], sums[1], sums[2]}, {sums[3], sums[4], sums[5]});
}

template <class T>
void DeviceBackend<T>::fold(const std::string& phase, int axis, const Manner& manner, GivenBySupport given) {
  if (!notes_reactions_ || periodic(axis)) return for_each_axis(phase, {axis}, manner);
  for (const VelocityField<T>& field : fields_) {
    Arguments<T> a = arguments_of(field, manner);
    a.axis = axis;
    note_walls(phase, a, given);
  }
}

template <class T>
void DeviceBackend<T>::note_beyond(int beyond, GivenBySupport given) {
  for (const int axis : walls_)
    for (const VelocityField<T>& field : fields_) {
      Arguments<T> a = arguments_of(field, {});
      a.axis = axis, a.beyond = beyond;
      note_walls("gathered_beyond", a, given);
    }
}

template <class T>
void DeviceBackend<T>::fold_momenta(const Manner& manner) {
  for (const int axis : walls_) fold("fold_masses", axis, manner, GivenBySupport::mirrored);
}

template <class T>
void DeviceBackend<T>::fold_forces() {
  if (!folds_forces_) return;
  for (const int axis : folded_axes()) fold("fold_forces", axis, {}, GivenBySupport::force);
}

template <class T>
void DeviceBackend<T>::fold_projection(bool at_rest) {
  for (const int axis : folded_axes())
    fold("fold_projection", axis, {false, false, at_rest}, GivenBySupport::projection);
}

template <class T>
void DeviceBackend<T>::impose_conditions(const Manner& manner) {
  const auto held = static_cast<std::size_t>(experiment_.support_of_rigid_body(0));
  for (std::size_t support = 0; notes_reactions_ && support < held; ++support)
    for (const VelocityField<T>& field : fields_) {
      Arguments<T> a = arguments_of(field, manner);
      a.support = static_cast<int>(support);
      const std::size_t at = place(support_sums);
      join("held", a, nodes(), support_sums, at);
      results_.later([this, at, number = a.support](const double* sums) {
        take_support(sums + at, GivenBySupport::held, number);
      });
    }
  for_each_field("impose_conditions", nodes(), manner);
}

template <class T>
void DeviceBackend<T>::record_reactions(const StepInfo& step) {
  if (!notes_reactions_) return;
  later([this] { reactions_.begin_gather(); });
  note_beyond(beyond_velocity, GivenBySupport::beyond);
  if (plan_.node_field("velocity_before")) note_beyond(beyond_change, GivenBySupport::beyond_increment);
  later([this, step] { reactions_.record(step); });
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
