#include "backends/device/device_backend.hpp"

#include <cmath>

namespace mpm::device {

template <class T>
void DeviceBackend<T>::resolve_contact(const StepInfo& step, Recorded recorded) {
  if (recorded == Recorded::after_forces) contact_ = {};
  Vector3 unbalanced{};
  ContactGiven given;
  given.pairs.reserve(contact_impulse_.pairs().size());
  const std::vector<ContactFields<T>> found(fields_.begin(), fields_.end());
  for (std::size_t a = 0; a < fields_.size(); ++a)
    for (std::size_t b = a + 1; b < fields_.size(); ++b) {
      pairs_.find(found[a], a, found[b], b);
      Arguments<T> arguments = scene_;
      arguments.grid = fields_[a].table(), arguments.other = fields_[b].table();
      arguments.contact = pairs_.table();
      launch("contact", arguments, nodes());
      pairs_.read();
      if (recorded == Recorded::after_forces) pairs_.add_to(contact_, unbalanced);
      pairs_.add_to(given, !contact_impulse_.pairs().empty());
    }
  Ledger* const ledger = scene_.records ? &ledger_ : nullptr;
  if (recorded == Recorded::before_forces) contact_impulse_.before_forces(given, step.filtered, ledger);
  if (recorded == Recorded::filter)
    contact_impulse_.in_filter(given, plan_.node_field("velocity_of_constraints") != nullptr, ledger);
  if (recorded != Recorded::after_forces) return;
  contact_impulse_.after_forces(given, ledger);
  contact_impulse_.record_counts(given);
  record_force(step);
  contact_.momentum_residual = std::hypot(unbalanced[0], unbalanced[1], unbalanced[2]);
}

template <class T>
void DeviceBackend<T>::record_force(const StepInfo& step) {
  const Vector3 impulse = contact_impulse_.handed_over(step.filtered);
  for (std::size_t c = 0; c < 3; ++c) contact_.force[c] = impulse[c] / step.dt;
  contact_impulse_.record_forces(step.filtered, step.dt);
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
