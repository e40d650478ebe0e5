#pragma once
// The memory of a list of fields holds one array [component][index] a field, one behind another.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "backends/device/fields.hpp"
#include "backends/device/kernels/arguments.hpp"

namespace mpm::device {

template <class T>
class FieldArrays {
 public:
  /// Starts with zeros.
  FieldArrays(std::vector<Field> fields, std::size_t count) : fields_(std::move(fields)), count_(count) {
    if (fields_.size() > most_fields)
      throw std::logic_error("a scene has " + std::to_string(fields_.size()) + " fields and the device's tables hold " +
                             std::to_string(most_fields));
    std::size_t scalars = 0;
    for (const Field& field : fields_) {
      first_.push_back(scalars * count);
      scalars += static_cast<std::size_t>(field.components);
    }
    values_.resize(scalars * count);
  }

  const std::vector<Field>& fields() const { return fields_; }
  std::size_t count() const { return count_; }
  std::uint64_t bytes() const { return values_.size() * sizeof(T); }

  /// The array of a field by its number; null for -1.
  T* of(int number) { return number < 0 ? nullptr : values_.data() + first_[static_cast<std::size_t>(number)]; }
  const T* of(int number) const {
    return number < 0 ? nullptr : values_.data() + first_[static_cast<std::size_t>(number)];
  }
  /// The array of a field of the host; null where there is none.
  T* of(std::string_view id) { return of(number_of(fields_, id)); }
  const T* of(std::string_view id) const { return of(number_of(fields_, id)); }
  std::size_t size(int number) const {
    return static_cast<std::size_t>(fields_[static_cast<std::size_t>(number)].components) * count_;
  }

  /// Fills a table of the kernels.
  void point(T** table) {
    for (int number = 0; number < static_cast<int>(fields_.size()); ++number) table[number] = of(number);
  }

  /// Turns [component][index] into doubles [index][component], times `unit`.
  std::vector<double> index_major(int number, double unit = 1) const {
    const T* const array = of(number);
    const auto components = static_cast<std::size_t>(fields_[static_cast<std::size_t>(number)].components);
    std::vector<double> result(size(number));
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = unit * array[i % components * count_ + i / components];
    return result;
  }
  /// Takes doubles [index][component] into [component][index].
  void take(int number, const std::vector<double>& values) {
    T* const array = of(number);
    const auto components = static_cast<std::size_t>(fields_[static_cast<std::size_t>(number)].components);
    for (std::size_t i = 0; i < values.size(); ++i)
      array[i % components * count_ + i / components] = static_cast<T>(values[i]);
  }

 private:
  std::vector<Field> fields_;
  std::size_t count_;
  std::vector<std::size_t> first_;
  std::vector<T> values_;
};

}  // namespace mpm::device
