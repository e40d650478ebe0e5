#pragma once
// What formulas at particles take beside places, on the device: found anew where the time of a step asks for it.

#include <optional>
#include <utility>
#include <vector>

#include "backends/device/device.hpp"
#include "backends/device/kernels/arguments.hpp"
#include "backends/device/particle_formulas.hpp"

namespace mpm::device {

template <class T>
class FormulaNumbers {
 public:
  FormulaNumbers(Device& device, const Experiment& experiment, Arguments<T>& scene)
      : formulas_(experiment), numbers_(device, "the numbers of formulas", formulas_.count()) {
    scene.formula_numbers = numbers_.data();
  }

  /// Hands over the numbers for a step between two times, s, without waiting for the device.
  void take(double begin, double end) {
    const std::pair times(begin, end);
    if (!formulas_.any() || (times_ && (!formulas_.use_time() || times == *times_))) return;
    const std::vector<double> numbers = formulas_.numbers(begin, end);
    numbers_.upload(std::vector<T>(numbers.begin(), numbers.end()));
    times_ = times;
  }

 private:
  ParticleFormulas formulas_;
  DeviceArray<T> numbers_;
  std::optional<std::pair<double, double>> times_;  ///< of the numbers there; empty before the first ones
};

}  // namespace mpm::device
