#pragma once
// Graphs of the host driver: what is put into a stream while it captures goes into a graph instead, whose operations run
// in order each time that it is launched.

#include <functional>
#include <vector>

#include "backends/device/drivers/driver.hpp"

namespace mpm::device {

using HostOperations = std::vector<std::function<void()>>;

struct OpaqueGraph {
  HostOperations operations;
};
struct OpaqueGraphExec {
  HostOperations operations;
};

/// Whether a stream captures what is put into it, behind what has waited in it before.
class HostCapture {
 public:
  bool on() const { return on_; }
  /// What CUDA does when something comes that no graph can hold: the capture is lost, and the call is refused.
  DriverResult refuse() {
    broken_ = true;
    return driver_capture_unsupported;
  }
  DriverResult begin(const HostOperations& waiting) {
    if (on_) return driver_illegal_state;
    on_ = true, broken_ = false, first_ = waiting.size();
    return driver_success;
  }
  /// Takes what was captured out of what waits.
  DriverResult end(HostOperations& waiting, GraphHandle* graph) {
    if (!on_) return driver_illegal_state;
    on_ = false;
    const auto first = waiting.begin() + static_cast<std::ptrdiff_t>(first_);
    *graph = broken_ ? nullptr : new OpaqueGraph{{first, waiting.end()}};
    waiting.erase(first, waiting.end());
    return broken_ ? driver_capture_invalidated : driver_success;
  }

 private:
  bool on_ = false, broken_ = false;
  std::size_t first_ = 0;
};

}  // namespace mpm::device
