#pragma once
// These tables tell kernels which loads there are and what the particles of a body carry of them.

#include <vector>

#include "backends/device/device.hpp"
#include "backends/device/kernels/arguments.hpp"
#include "experiment/experiment.hpp"
#include "simulation/loads.hpp"

namespace mpm::device {

/// How each load of an experiment acts, in its order.
template <class T>
std::vector<LoadLaw<T>> laws_of_loads(const Experiment& experiment) {
  std::vector<LoadLaw<T>> laws;
  for (const Load& load : experiment.loads) {
    LoadLaw<T> law{};
    law.action = load.type == LoadType::spring     ? load_of_spring
                 : load.type != LoadType::pressure ? load_of_force
                 : load.follower                   ? load_of_follower
                                                   : load_of_pressure;
    for (const ExternalForce kind : external_forces) law.gives |= int{load.gives(kind)} << static_cast<int>(kind);
    for (int c = 0; c < 3; ++c) {
      law.stiffness[c] = static_cast<T>(load.stiffness[c]);
      law.damping[c] = static_cast<T>(load.damping[c]);
    }
    laws.push_back(law);
  }
  return laws;
}

/// What the particles of one body carry of loads at points, on the device; nothing where none acts.
template <class T>
class CarriedLoads {
 public:
  CarriedLoads(Device& device, const std::string& body, const BodyLoads& loads)
      : first_(device, "the loads of " + body), shares_(device, "the loads of " + body) {
    const auto narrowed = [](const double* from, int count, T* to) {
      for (int k = 0; k < count; ++k) to[k] = static_cast<T>(from[k]);
    };
    std::vector<LoadShare<T>> shares;
    for (const LoadShare<double>& share : loads.shares()) {
      LoadShare<T>& one = shares.emplace_back(LoadShare<T>{share.load, static_cast<T>(share.measure), {}, {}, {}});
      narrowed(share.first, 3, one.first);
      narrowed(share.area, 3, one.area);
      narrowed(share.area_moment, 9, one.area_moment);
    }
    first_.upload(std::vector<int>(loads.first_shares().begin(), loads.first_shares().end()));
    shares_.upload(shares);
  }

  LoadsOfBody<T> table() const { return {first_.data(), shares_.data()}; }

 private:
  DeviceArray<int> first_;
  DeviceArray<LoadShare<T>> shares_;
};

}  // namespace mpm::device
