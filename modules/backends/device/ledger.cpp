#include "backends/device/device_backend.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::account_for_impulses() {
  for (VelocityField<T>& field : fields_) {
    const auto work = sum<11>("work_of_forces", arguments_of(field, {}), nodes());
    book(&Ledger::internal_force, work[0]), book(&Ledger::body_force, work[1]), book(&Ledger::gravity, work[2]);
    for (const ExternalForce kind : external_forces)
      if (kind != ExternalForce::body_force) book(row_of(kind), work[5 + static_cast<std::size_t>(kind)]);
    book(&Ledger::boundary, work[3]), book(&Ledger::contact, work[4]),
        book(&Ledger::gravity_without_potential, work[5]);
    book(&Ledger::damping, work[10]);
  }
  energy_after_ = sum_over_nodes("energy_of_velocities");
  lumped_power_ = power_of_forces();
}

template <class T>
void DeviceBackend<T>::begin_stage(bool records) {
  scene_.records = records;
  if (records) for_each_field("clear_impulses", vectors());
}

template <class T>
void DeviceBackend<T>::book(double Ledger::*row, double work) {
  ledger_.*row += work;
  works_ += work;
}

template <class T>
void DeviceBackend<T>::book_folds() {
  for (VelocityField<T>& field : fields_) {
    const auto work = sum<2>("work_of_folds", arguments_of(field, {}), nodes());
    book(&Ledger::boundary, work[0]);
    ledger_.boundary += work[1];
  }
  for_each_field("clear_work_of_folds", nodes());
}

template <class T>
void DeviceBackend<T>::book_impulses() {
  for (VelocityField<T>& field : fields_) {
    const auto work = sum<3>("work_of_impulses", arguments_of(field, {}), nodes());
    book(&Ledger::boundary, work[0]), book(&Ledger::contact, work[1]), book(&Ledger::filter, work[2]);
  }
}

template <class T>
void DeviceBackend<T>::book_filter() {
  const double works = works_, before = energy_after_;
  book_impulses();
  energy_after_ = sum_over_nodes("energy_of_velocities");
  ledger_.filter_book += energy_after_ - before - (works_ - works);
  works_ = works + energy_after_ - before;
}

template <class T>
std::array<double, 2> DeviceBackend<T>::power_of_forces() {
  std::array<double, 2> power{};
  for (VelocityField<T>& field : fields_) {
    const auto of_field = sum<2>("power_of_forces", arguments_of(field, {}), nodes());
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += of_field[k];
  }
  return power;
}

template <class T>
void DeviceBackend<T>::book_strain(double Ledger::*row, double share) {
  ledger_.*row -= share * (power_of_forces()[0] - lumped_power_[0]);
}

template <class T>
double DeviceBackend<T>::power_of_filter() {
  return sum_over_nodes("power_of_filter");
}

template <class T>
void DeviceBackend<T>::book_material(Body<T>& body) {
  const auto [dissipated, power, stored] = sum<3>("energy_dissipated", arguments_of(body), body.count);
  ledger_.material += dissipated, ledger_.stress_power += power, ledger_.stored += stored;
  ledger_.material_book += power - stored - dissipated;
}

template <class T>
double DeviceBackend<T>::energy_of_particles() {
  double energy = 0;
  for (Body<T>& body : bodies_) energy += sum_over_particles("energy_of_particles", body);
  return energy;
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
