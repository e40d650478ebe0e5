#include "backends/device/device_backend.hpp"

#include <algorithm>
#include <cmath>

#include "backends/device/kernels/contact.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::resolve_contact(const StepInfo& step, Recorded recorded) {
  if (contact_pairs_ && recorded == Recorded::before_forces) {
    look();  // a particle that has failed is nowhere
    contact_pairs_->find(bodies_, fields_);
  }
  const auto given = std::make_shared<ContactGiven>();
  const Tally<3> unbalanced = tally<3>();
  const bool after_forces = recorded == Recorded::after_forces;
  later([this, given, after_forces] {
    *given = {};
    if (after_forces) contact_ = {};
  });
  for (std::size_t a = 0; a < fields_.size(); ++a)
    for (std::size_t b = a + 1; b < fields_.size(); ++b) {
      Arguments<T> arguments = scene_;
      arguments.grid = fields_[a].table(), arguments.other = fields_[b].table();
      arguments.edges[0] = edges_.of(a), arguments.edges[1] = edges_.of(b);
      if (contact_pairs_) arguments.found = contact_pairs_->of(static_cast<int>(a), static_cast<int>(b));
      const std::size_t at = place(contact_sums);
      join("contact", arguments, nodes(), contact_sums, at, 1);
      results_.later([this, at, given, unbalanced, after_forces](const double* sums) {
        const double* const found = sums + at;
        for (std::size_t c = 0; c < 3; ++c) (*unbalanced)[c] += found[contact_unbalanced + c];
        take_pair(found, *given, after_forces);
      });
    }
  Ledger* const ledger = scene_.records ? &ledger_ : nullptr;
  later([this, recorded, given, ledger, filtered = step.filtered] {
    if (recorded == Recorded::before_forces) contact_impulse_.before_forces(*given, filtered, ledger);
    if (recorded == Recorded::filter)
      contact_impulse_.in_filter(*given, plan_.node_field("velocity_of_constraints") != nullptr, ledger);
    if (recorded != Recorded::after_forces) return;
    contact_impulse_.after_forces(*given, ledger);
    contact_impulse_.record_counts(*given);
  });
  if (!after_forces) return;
  record_force(step);
  later([this, unbalanced] {
    const auto [x, y, z] = *unbalanced;
    contact_.momentum_residual = std::hypot(x, y, z);
  });
}

template <class T>
void DeviceBackend<T>::take_pair(const double* sums, ContactGiven& given, bool record) {
  PairGiven pair;
  for (std::size_t c = 0; c < 3; ++c)
    pair.impulse[c] = sums[contact_impulse + c], pair.along[c] = sums[contact_along + c];
  pair.pressing = sums[contact_pressing];
  pair.sticking = std::lround(sums[contact_sticking]), pair.slipping = std::lround(sums[contact_slipping]);
  pair.area = sums[contact_touching], pair.largest_penetration = sums[contact_penetration];
  for (std::size_t c = 0; c < 3; ++c) given.impulse[c] += pair.impulse[c];
  given.dissipated += sums[contact_dissipated];
  if (!contact_impulse_.pairs().empty()) given.pairs.push_back(pair);
  if (!record) return;
  contact_.sticking += pair.sticking, contact_.slipping += pair.slipping;
  contact_.nodes += pair.sticking + pair.slipping;
  contact_.largest_penetration = std::max(contact_.largest_penetration, pair.largest_penetration);
}

template <class T>
void DeviceBackend<T>::record_force(const StepInfo& step) {
  later([this, filtered = step.filtered, dt = step.dt] {
    const Vector3 impulse = contact_impulse_.handed_over(filtered);
    for (std::size_t c = 0; c < 3; ++c) contact_.force[c] = impulse[c] / dt;
    contact_impulse_.record_forces(filtered, dt);
  });
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
