#pragma once
// The memory of a list of fields on a device holds one array [component][index] a field, one behind another.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "backends/device/device.hpp"
#include "backends/device/fields.hpp"

namespace mpm::device {

template <class T>
class FieldArrays {
 public:
  /// Starts with zeros. `owner` names in messages whose fields they are. Throws DeviceError.
  FieldArrays(Device& device, const std::string& owner, std::vector<Field> fields, std::size_t count)
      : fields_(std::move(fields)), count_(count), values_(device, owner) {
    if (fields_.size() > most_fields)
      throw std::logic_error("a scene has " + std::to_string(fields_.size()) + " fields and the device's tables hold " +
                             std::to_string(most_fields));
    std::size_t scalars = 0;
    for (const Field& field : fields_) {
      first_.push_back(scalars * count);
      scalars += static_cast<std::size_t>(field.components);
    }
    values_.resize(scalars * count);
    values_.clear();
  }

  const std::vector<Field>& fields() const { return fields_; }
  std::size_t count() const { return count_; }
  std::uint64_t bytes() const { return values_.bytes(); }
  int number(std::string_view id) const { return number_of(fields_, id); }
  int number(const Field& field) const { return number_of(fields_, field.id, field.origin); }

  /// The device's array of a field by its number; null for -1.
  T* of(int number) const { return number < 0 ? nullptr : values_.data() + first(number); }
  /// The device's array of a field of the host; null where there is none.
  T* of(std::string_view id) const { return of(number(id)); }
  std::size_t size(int number) const {
    return static_cast<std::size_t>(fields_[static_cast<std::size_t>(number)].components) * count_;
  }

  /// Waits for the values of a field, [component][index]; empty for -1.
  std::vector<T> read(int number) const {
    return number < 0 ? std::vector<T>() : values_.download(first(number), size(number));
  }
  std::vector<T> read(std::string_view id) const { return read(number(id)); }
  /// Replaces the values of a field, [component][index].
  void write(int number, const std::vector<T>& values) { values_.upload(values.data(), first(number), size(number)); }
  void write(std::string_view id, const std::vector<T>& values) { write(number(id), values); }
  void fill(int number, unsigned char byte) const { values_.fill(byte, first(number), size(number)); }
  /// Copies a field into another of as many components.
  void copy(int to, int from) { values_.copy(first(to), first(from), size(from)); }

  /// Fills a table of the kernels.
  void point(T** table) const {
    for (int number = 0; number < static_cast<int>(fields_.size()); ++number) table[number] = of(number);
  }

  /// Waits for the values as doubles [index][component], times `unit`.
  std::vector<double> index_major(int number, double unit = 1) const {
    const std::vector<T> array = read(number);
    const auto components = static_cast<std::size_t>(fields_[static_cast<std::size_t>(number)].components);
    std::vector<double> result(array.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = unit * array[i % components * count_ + i / components];
    return result;
  }
  /// Takes doubles [index][component] into [component][index].
  void take(int number, const std::vector<double>& values) {
    const auto components = static_cast<std::size_t>(fields_[static_cast<std::size_t>(number)].components);
    std::vector<T> array(size(number));
    for (std::size_t i = 0; i < values.size(); ++i)
      array[i % components * count_ + i / components] = static_cast<T>(values[i]);
    if (!values.empty()) write(number, array);
  }

 private:
  std::size_t first(int number) const { return first_[static_cast<std::size_t>(number)]; }

  std::vector<Field> fields_;
  std::size_t count_;
  std::vector<std::size_t> first_;
  DeviceArray<T> values_;
};

}  // namespace mpm::device
