#include "backends/device/device_backend.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::account_for_impulses() {
  for (VelocityField<T>& field : fields_) {
    const Tally<11> sums = sum<11>("work_of_forces", arguments_of(field, {}), nodes());
    later([this, sums] {
      const std::array<double, 11>& work = *sums;
      book(&Ledger::internal_force, work[0]), book(&Ledger::body_force, work[1]), book(&Ledger::gravity, work[2]);
      for (const ExternalForce kind : external_forces)
        if (kind != ExternalForce::body_force) book(row_of(kind), work[5 + static_cast<std::size_t>(kind)]);
      book(&Ledger::boundary, work[3]), book(&Ledger::contact, work[4]),
          book(&Ledger::gravity_without_potential, work[5]);
      book(&Ledger::damping, work[10]);
    });
  }
  const Tally<1> energy = sum_over_nodes("energy_of_velocities");
  const Tally<2> power = power_of_forces();
  later([this, energy, power] { energy_after_ = (*energy)[0], lumped_power_ = *power; });
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
    const Tally<2> work = sum<2>("work_of_folds", arguments_of(field, {}), nodes());
    later([this, work] {
      book(&Ledger::boundary, (*work)[0]);
      ledger_.boundary += (*work)[1];
    });
  }
  for_each_field("clear_work_of_folds", nodes());
}

template <class T>
void DeviceBackend<T>::book_impulses() {
  for (VelocityField<T>& field : fields_) {
    const Tally<3> work = sum<3>("work_of_impulses", arguments_of(field, {}), nodes());
    later([this, work] {
      book(&Ledger::boundary, (*work)[0]), book(&Ledger::contact, (*work)[1]), book(&Ledger::filter, (*work)[2]);
    });
  }
}

template <class T>
void DeviceBackend<T>::book_filter() {
  const Tally<2> before = tally<2>();
  later([this, before] { *before = {works_, energy_after_}; });
  book_impulses();
  const Tally<1> energy = sum_over_nodes("energy_of_velocities");
  later([this, before, energy] {
    energy_after_ = (*energy)[0];
    const double gained = energy_after_ - (*before)[1];
    ledger_.filter_book += gained - (works_ - (*before)[0]);
    works_ = (*before)[0] + gained;
  });
}

template <class T>
Tally<2> DeviceBackend<T>::power_of_forces() {
  const Tally<2> power = tally<2>();
  for (VelocityField<T>& field : fields_) sum<2>("power_of_forces", arguments_of(field, {}), nodes(), power);
  return power;
}

template <class T>
void DeviceBackend<T>::book_strain(double Ledger::*row, double share) {
  const Tally<2> power = power_of_forces();
  later([this, row, share, power] { ledger_.*row -= share * ((*power)[0] - lumped_power_[0]); });
}

template <class T>
void DeviceBackend<T>::book_material(Body<T>& body) {
  const Tally<3> sums = sum<3>("energy_dissipated", arguments_of(body), body.count);
  const Tally<1> artificial = tally<1>();
  if (body.viscosity.density > 0) sum<1>("artificial_work", arguments_of(body), body.count, artificial);
  later([this, cause = body.dissipation, sums, artificial] {
    const auto [dissipated, power, stored] = *sums;
    ledger_.enter_strain(cause, {dissipated, (*artificial)[0], power, stored});
  });
}

template <class T>
Tally<1> DeviceBackend<T>::energy_of_particles() {
  const Tally<1> energy = tally<1>();
  for (Body<T>& body : bodies_) sum_over_particles("energy_of_particles", body, energy);
  return energy;
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
