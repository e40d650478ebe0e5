#include <cstring>

#include "backends/device/device_backend.hpp"
#include "simulation/saved_state.hpp"

namespace mpm::device {

/// What a step has found of particles for the next one's scatter. Found anew it may be another rounding.
constexpr const char* prepared_fields[] = {"stress", "volume_ratio"};

template <class T>
std::vector<char> DeviceBackend<T>::prepared_values() const {
  std::vector<char> bytes;
  if (!prepared_) return bytes;
  for (const Body<T>& body : bodies_)
    for (const char* id : prepared_fields) {
      const std::vector<T> values = body.arrays.read(id);
      const char* const first = reinterpret_cast<const char*>(values.data());
      bytes.insert(bytes.end(), first, first + values.size() * sizeof(T));
    }
  return bytes;
}

template <class T>
void DeviceBackend<T>::take_prepared_values(const std::vector<char>& bytes) {
  prepared_ = !bytes.empty();
  if (!prepared_) return;
  std::size_t at = 0;
  for (Body<T>& body : bodies_) {
    for (const char* id : prepared_fields) {
      const int number = body.number(id);
      std::vector<T> values(body.arrays.size(number));
      if (bytes.size() < at + values.size() * sizeof(T)) throw ArchiveError("the device's stresses are cut short");
      std::memcpy(values.data(), bytes.data() + at, values.size() * sizeof(T));
      at += values.size() * sizeof(T);
      body.arrays.write(number, values);
    }
    find_blocks(body);
  }
}

template <class T>
void DeviceBackend<T>::save(ArchiveWriter& archive) const {
  save_records(archive, *this);
  save_arrangement(archive, "cuda", prepared_values());
  for (std::size_t index = 0; index < bodies_.size(); ++index) {
    const FieldArrays<T>& arrays = bodies_[index].arrays;
    save_particles(archive, plan_, static_cast<int>(index), arrays.index_major(arrays.number("position")),
                   [&](const Field& field) {
                     const std::vector<double> values = arrays.index_major(arrays.number(field));
                     return std::vector<T>(values.begin(), values.end());
                   });
  }
}

template <class T>
void DeviceBackend<T>::restore(ArchiveReader& archive) {
  SavedRecords records = restore_records(archive, *this);
  const std::vector<char> prepared = restore_arrangement(archive, "cuda");
  ledger_ = records.ledger, heat_ledger_ = records.heat_ledger;
  contact_ = records.contact, contact_impulse_.pairs() = std::move(records.contact_pairs);
  filter_ = records.filter, limit_ = records.limit;
  reactions_.resume(std::move(records.reactions)), rigid_.bodies().resume(std::move(records.rigid_bodies));
  for (std::size_t index = 0; index < bodies_.size(); ++index) {
    FieldArrays<T>& arrays = bodies_[index].arrays;
    restore_particles<T>(
        archive, plan_, static_cast<int>(index), arrays.count(), static_cast<std::size_t>(experiment_.dimension),
        [&](const std::vector<double>& position) { arrays.take(arrays.number("position"), position); },
        [&](const Field& field, const std::vector<T>& values) {
          arrays.take(arrays.number(field), {values.begin(), values.end()});
        });
    // A step strains its domains further from where the last one left them.
    if (const int strained = arrays.number("strained_domain"); strained >= 0)
      arrays.copy(strained, arrays.number("domain"));
  }
  take_prepared_values(prepared);
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
  device_->launch("second_moments", a, (body.count + lanes_ - 1) / lanes_, lanes_);
  const double h = experiment_.grid.cell_size;
  return body.arrays.index_major(number, h * h);
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
