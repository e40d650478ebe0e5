#include "backends/device/device_backend.hpp"

namespace mpm::device {

template <class T>
void DeviceBackend<T>::save(ArchiveWriter& archive) const {
  for (const Body<T>& body : bodies_)
    for_each_saved(body, [&](const Field& field, int number) {
      const std::vector<T> values = body.arrays.read(number);
      archive.put(field.id, values.data(), values.size());
    });
  archive.put("ledger", ledger_);
  if (plan_.has_heat_ledger()) archive.put("heat ledger", heat_ledger_);
  archive.put("contact", contact_);
  archive.put("contact_pairs", contact_impulse_.pairs());
  archive.put("filter", filter_);
  reactions_.save(archive);
  archive.put("limit speeds", std::array{limit_.speed, limit_.wave_speed});
  archive.put("limit particle", std::array<std::uint64_t, 2>{static_cast<std::uint64_t>(limit_.body), limit_.particle});
}

template <class T>
void DeviceBackend<T>::restore(ArchiveReader& archive) {
  for (Body<T>& body : bodies_) {
    for_each_saved(body, [&](const Field& field, int number) {
      std::vector<T> values(body.arrays.size(number));
      archive.get(field.id, values.data(), values.size());
      body.arrays.write(number, values);
    });
    // A step strains its domains further from where the last one left them.
    if (const int strained = body.number("strained_domain"); strained >= 0)
      body.arrays.copy(strained, body.number("domain"));
  }
  archive.get("ledger", ledger_);
  if (plan_.has_heat_ledger()) archive.get("heat ledger", heat_ledger_);
  archive.get("contact", contact_);
  archive.get("contact_pairs", contact_impulse_.pairs());
  archive.get("filter", filter_);
  reactions_.restore(archive);
  std::array<double, 2> speeds{};
  std::array<std::uint64_t, 2> particle{};
  archive.get("limit speeds", speeds);
  archive.get("limit particle", particle);
  limit_ = {speeds[0], speeds[1], static_cast<int>(particle[0]), particle[1]};
}

template <class T>
BodyState DeviceBackend<T>::body_state(int index) const {
  const Body<T>& body = bodies_[static_cast<std::size_t>(index)];
  const double h = experiment_.grid.cell_size;
  BodyState state;
  for_each_saved(body, [&](const Field& field, int number) {
    state.of(field) = body.arrays.index_major(number, field.unit == "cells" ? h : 1);
  });
  state.initial_position = body.initial_position;
  state.mass = body.mass, state.volume = body.volume;
  if (plan_.stencil.second_moment) state.second_moment = second_moments(body);
  return state;
}

template <class T>
std::vector<double> DeviceBackend<T>::second_moments(const Body<T>& body) const {
  constexpr unsigned char not_a_number = 0xff;
  const int number = body.number("second_moment");
  body.arrays.fill(number, not_a_number);
  Arguments<T> a = arguments_of(body);
  a.stop = ignored_stop_.data();
  device_->launch("second_moments", a, (body.count + lanes_ - 1) / lanes_, lanes_);
  const double h = experiment_.grid.cell_size;
  return body.arrays.index_major(number, h * h);
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
