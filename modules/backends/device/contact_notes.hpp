#pragma once
// What contact does at single nodes, written down by the device where a run records it. The host reads it after each
// stage of contact, as the next stage writes over it: such steps wait, and are in no graph.

#include <vector>

#include "backends/device/device.hpp"
#include "backends/device/kernels/arguments.hpp"
#include "simulation/contact_impulse.hpp"

namespace mpm::device {

template <class T>
class ContactNotes {
 public:
  ContactNotes(Device& device, const Experiment& experiment, const Arguments<T>& scene)
      : dimension_(experiment.dimension), fields_(experiment.field_count), scene_(scene) {
    for (int k = 0; k < fields_ * (fields_ - 1) / 2; ++k) pairs_.emplace_back(device, nodes(), dimension_);
  }

  /// Where the nodes of fields a < b go, at the device's addresses.
  NotedContact<T> of(int a, int b) const {
    const Pair& pair = pairs_[pair_index(a, b, fields_)];
    return {pair.met.data(), pair.values.data()};
  }

  /// Appends the nodes where fields meet, pair by pair. Waits for the device.
  void read(std::vector<NodeGiven>& to) const {
    for (int a = 0; a < fields_; ++a)
      for (int b = a + 1; b < fields_; ++b) read(a, b, to);
  }

 private:
  struct Pair {
    DeviceArray<int> met;
    DeviceArray<T> values;
    Pair(Device& device, std::size_t nodes, int dimension)
        : met(device, "contact nodes", nodes),
          values(device, "contact nodes", static_cast<std::size_t>(numbers_of(dimension)) * nodes) {}
  };
  static int numbers_of(int dimension) { return 2 + 2 * dimension; }
  std::size_t nodes() const { return static_cast<std::size_t>(scene_.node_count); }

  void read(int a, int b, std::vector<NodeGiven>& to) const {
    const Pair& pair = pairs_[pair_index(a, b, fields_)];
    const std::vector<int> met = pair.met.download();
    const std::vector<T> values = pair.values.download();
    for (std::size_t node = 0; node < met.size(); ++node) {
      if (met[node] < 0) continue;
      const auto value = [&](int number) { return values[static_cast<std::size_t>(number) * met.size() + node]; };
      NodeGiven& given = to.emplace_back();
      given.node.a = a, given.node.b = b, given.node.status = met[node];
      given.node.separation = value(0), given.node.area = value(1);
      auto rest = static_cast<int>(node);
      for (int c = 0; c < dimension_; rest /= scene_.extent[c], ++c) {
        given.node.node[c] = rest % scene_.extent[c] - scene_.padding[c];
        given.node.normal[c] = value(2 + c), given.impulse[c] = value(2 + dimension_ + c);
      }
    }
  }

  int dimension_, fields_;
  const Arguments<T>& scene_;
  std::vector<Pair> pairs_;  ///< [pair_index]
};

}  // namespace mpm::device
