#include "backends/device/device_backend.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::heat_to_temperature() {
  for_each_field("divide_heat", nodes());
  if (plan_.has_heat_ledger()) {
    const Tally<1> heat = sum_over_nodes("heat_of_temperatures");
    later([this, heat] { heat_ledger_.scatter += (*heat)[0] - heat_of_images_ - scattered_heat_; });
  }
  const Tally<2> held = impose_temperature(), beyond = fill_temperature();
  later([this, held, beyond] {
    beyond_ = *beyond;
    if (plan_.has_heat_ledger())
      heat_ledger_.images += heat_of_images_ + (*held)[0] + (*held)[1] + beyond_[0] + beyond_[1];
  });
  for_each_field("keep_temperature", nodes());
}

template <class T>
Tally<2> DeviceBackend<T>::impose_temperature() {
  const Tally<2> given = tally<2>();
  for (VelocityField<T>& field : fields_) sum<2>("impose_temperature", arguments_of(field, {}), nodes(), given);
  return given;
}

template <class T>
Tally<2> DeviceBackend<T>::fill_temperature() {
  const Tally<2> beyond = tally<2>();
  for (const int axis : filled_axes())
    for (VelocityField<T>& field : fields_) sum_over_lines("fill_temperature", field, axis, beyond);
  return beyond;
}

template <class T>
void DeviceBackend<T>::sum_over_lines(const char* phase, VelocityField<T>& field, int axis, const Tally<2>& to) {
  Arguments<T> a = arguments_of(field, {});
  a.axis = axis;
  sum<2>(phase, a, lines_along(axis), to);
}

template <class T>
void DeviceBackend<T>::conduct() {
  for (Body<T>& body : bodies_) run_blocks("conduct", arguments_of(body), body);
}

template <class T>
void DeviceBackend<T>::warm(const StepInfo& step) {
  const double dt = step.dt;
  const bool records = plan_.has_heat_ledger(), records_folds = records && heat_conditions_->walls_act();
  const Tally<1> rate = records_folds ? sum_over_nodes("heat_rate_of_nodes") : nullptr;
  for_each_axis("fold_forces", folded_axes());
  if (records_folds) {
    const Tally<1> folded = sum_over_nodes("heat_rate_of_nodes");
    later([this, dt, rate, folded] { heat_ledger_.walls += dt * ((*folded)[0] - (*rate)[0]); });
  }
  const Tally<2> rates = tally<2>();
  for (const int axis : heat_conditions_->exchanging_axes())
    for (VelocityField<T>& field : fields_) sum_over_lines("exchange_at_walls", field, axis, rates);
  if (records)
    later([this, dt, rates] { heat_ledger_.flux += dt * (*rates)[0], heat_ledger_.convection += dt * (*rates)[1]; });
  for (const int box : heat_conditions_->warmed_boxes()) warm_box(box, dt);
  for_each_field("warm", nodes());
  heat_conditions_->evaluate(step.time + step.dt, scene_);
  const Tally<2> held = impose_temperature(), beyond = fill_temperature();
  if (!records) return;
  const Tally<1> after = sum_over_nodes("heat_of_temperatures");
  later([this, held, beyond, after] {
    const auto [at_walls, elsewhere] = *beyond;
    heat_ledger_.walls += (*held)[0] + at_walls - beyond_[0];
    heat_ledger_.boxes += (*held)[1];
    heat_ledger_.images += elsewhere - beyond_[1];
    heat_after_ = (*after)[0] + at_walls + elsewhere;
  });
}

template <class T>
void DeviceBackend<T>::warm_box(int box, double dt) {
  // The masses of all velocity fields stay on the device, one behind another.
  const std::size_t masses = place(fields_.size());
  const auto of_box = [&](VelocityField<T>& field) {
    Arguments<T> a = arguments_of(field, {});
    a.heat_box = box;
    return a;
  };
  for (std::size_t k = 0; k < fields_.size(); ++k) join("mass_of_box", of_box(fields_[k]), nodes(), 1, masses + k);
  const Tally<1> power = tally<1>();
  for (VelocityField<T>& field : fields_) {
    Arguments<T> a = of_box(field);
    a.masses_of_box = results_.at(masses), a.mass_count = static_cast<int>(fields_.size());
    sum<1>("warm_box", a, nodes(), power);
  }
  if (plan_.has_heat_ledger()) later([this, dt, power] { heat_ledger_.boxes += dt * (*power)[0]; });
}

template <class T>
void DeviceBackend<T>::change_phase() {
  for (Body<T>& body : bodies_) {
    if (!body.melts()) continue;
    run_material("change_phase", body);
    if (!accounted_) continue;
    const Tally<3> sums = sum<3>("energy_dissipated", arguments_of(body), body.count);
    later([this, sums] { ledger_.enter_phase_change((*sums)[0]); });
  }
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
