#include "backends/device/device_backend.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::heat_to_temperature() {
  for_each_field("divide_heat", nodes());
  if (plan_.has_heat_ledger())
    heat_ledger_.scatter += sum_over_nodes("heat_of_temperatures") - heat_of_images_ - scattered_heat_;
  const HeatOfTwo held = impose_temperature();
  beyond_ = fill_temperature();
  if (plan_.has_heat_ledger()) heat_ledger_.images += heat_of_images_ + held[0] + held[1] + beyond_[0] + beyond_[1];
  for_each_field("keep_temperature", nodes());
}

template <class T>
HeatOfTwo DeviceBackend<T>::impose_temperature() {
  HeatOfTwo given{};
  for (VelocityField<T>& field : fields_) {
    const HeatOfTwo of_field = sum<2>("impose_temperature", arguments_of(field, {}), nodes());
    given[0] += of_field[0], given[1] += of_field[1];
  }
  return given;
}

template <class T>
HeatOfTwo DeviceBackend<T>::fill_temperature() {
  HeatOfTwo beyond{};
  for (const int axis : filled_axes())
    for (VelocityField<T>& field : fields_) {
      const HeatOfTwo of_field = sum_over_lines("fill_temperature", field, axis);
      beyond[0] += of_field[0], beyond[1] += of_field[1];
    }
  return beyond;
}

template <class T>
HeatOfTwo DeviceBackend<T>::sum_over_lines(const char* phase, VelocityField<T>& field, int axis) {
  Arguments<T> a = arguments_of(field, {});
  a.axis = axis;
  return sum<2>(phase, a, lines_along(axis));
}

template <class T>
void DeviceBackend<T>::conduct() {
  for (Body<T>& body : bodies_) run_blocks("conduct", arguments_of(body), body);
}

template <class T>
void DeviceBackend<T>::warm(const StepInfo& step) {
  const bool records_folds = plan_.has_heat_ledger() && heat_conditions_->walls_act();
  const double rate = records_folds ? sum_over_nodes("heat_rate_of_nodes") : 0.0;
  for_each_axis("fold_forces", folded_axes());
  if (records_folds) heat_ledger_.walls += step.dt * (sum_over_nodes("heat_rate_of_nodes") - rate);
  for (const int axis : heat_conditions_->exchanging_axes())
    for (VelocityField<T>& field : fields_) {
      const HeatOfTwo rates = sum_over_lines("exchange_at_walls", field, axis);
      if (plan_.has_heat_ledger())
        heat_ledger_.flux += step.dt * rates[0], heat_ledger_.convection += step.dt * rates[1];
    }
  for (const int box : heat_conditions_->warmed_boxes()) warm_box(box, step.dt);
  for_each_field("warm", nodes());
  heat_conditions_->evaluate(step.time + step.dt, scene_);
  const HeatOfTwo held = impose_temperature(), beyond = fill_temperature();
  if (!plan_.has_heat_ledger()) return;
  heat_ledger_.walls += held[0] + beyond[0] - beyond_[0];
  heat_ledger_.boxes += held[1];
  heat_ledger_.images += beyond[1] - beyond_[1];
  heat_after_ = sum_over_nodes("heat_of_temperatures") + beyond[0] + beyond[1];
}

template <class T>
void DeviceBackend<T>::warm_box(int box, double dt) {
  double mass = 0;
  const auto over_fields = [&](const char* phase) {
    double total = 0;
    for (VelocityField<T>& field : fields_) {
      Arguments<T> a = arguments_of(field, {});
      a.heat_box = box, a.mass_of_box = static_cast<T>(mass);
      total += sum(phase, a, nodes())[0];
    }
    return total;
  };
  mass = over_fields("mass_of_box");
  if (!(mass > 0)) return;
  const double power = over_fields("warm_box");
  if (plan_.has_heat_ledger()) heat_ledger_.boxes += dt * power;
}

template <class T>
void DeviceBackend<T>::change_phase() {
  for (Body<T>& body : bodies_) {
    if (!body.melts()) continue;
    run_material("change_phase", body);
    if (!accounted_) continue;
    const double lost = sum<3>("energy_dissipated", arguments_of(body), body.count)[0];
    ledger_.material += lost, ledger_.stored -= lost;
  }
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
