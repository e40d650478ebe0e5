#pragma once
// The tables by which contact tells where the edges of bodies are (simulation/contact_detection.hpp), on the device.

#include <vector>

#include "backends/device/device.hpp"
#include "simulation/contact_detection.hpp"

namespace mpm::device {

class ContactEdges {
 public:
  /// There are none where nobody reads them.
  ContactEdges(Device& device, const Experiment& experiment) : values_(device, "the edges of bodies") {
    std::vector<double> all;
    for (const EdgeModel& model : edge_models(experiment)) {
      const EdgeTable table = model.table();
      places_.push_back({all.size(), table.count});
      all.insert(all.end(), table.edges, table.edges + table.count);
      all.insert(all.end(), table.means, table.means + table.count);
    }
    values_.upload(all);
  }
  /// The table of a velocity field, at the device's addresses.
  EdgeTable of(std::size_t field) const {
    if (places_.empty()) return {};
    const auto [first, count] = places_[field];
    return {values_.data() + first, values_.data() + first + count, count};
  }

 private:
  struct Place {
    std::size_t first;
    int count;
  };
  std::vector<Place> places_;
  DeviceArray<double> values_;
};

}  // namespace mpm::device
