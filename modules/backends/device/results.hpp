#pragma once
// What the phases of a step leave for the host on the device: sums, and the particle that stopped them. The host reads all
// of it at once after the step, and only then does what was to be done with each.

#include <cstring>
#include <functional>
#include <vector>

#include "backends/device/device.hpp"
#include "backends/device/kernels/stopping.hpp"

namespace mpm::device {

class Results {
 public:
  /// What to do with the sums of a step, which are given from the first one on.
  using Use = std::function<void(const double* sums)>;

  /// Numbers of double precision on the device: the first one's bits say who has stopped, sums take the others.
  static constexpr std::size_t stops = 1, room = 8192, numbers = stops + room;
  static_assert(sizeof(Stopped) == stops * sizeof(double));

  explicit Results(Device& device) : values_(device, "sums", numbers) { forget(); }

  /// Whether so many sums more find a place.
  bool has_room_for(std::size_t count) const { return used_ + count <= room; }
  /// Gives a place to so many sums; returns its number.
  std::size_t place(std::size_t count) {
    used_ += count;
    return used_ - count;
  }
  /// The device's address of a place.
  double* at(std::size_t place) const { return values_.data() + stops + place; }
  /// Where phases report particles (kernels/stopping.hpp).
  Stopped* stop() const { return reinterpret_cast<Stopped*>(values_.data()); }

  /// Keeps what to do with sums once they are known; uses come in the order in which they were kept.
  void later(Use use) { uses_.push_back(std::move(use)); }
  bool waits() const { return !uses_.empty(); }
  /// The uses that are kept, and the room that their sums take: those of a step may be taken up again after another one
  /// of the same kind.
  std::vector<Use> uses() const { return uses_; }
  std::size_t used() const { return used_; }
  void take_up(const std::vector<Use>& uses, std::size_t used) { uses_ = uses, used_ = used; }

  /// Waits for the device; returns what phases have reported, or else makes all uses. Either way all is forgotten.
  Stopped look() {
    const std::vector<double> found = values_.download(0, stops + used_);
    Stopped stopped = nothing_stopped;
    std::memcpy(&stopped, found.data(), sizeof stopped);
    std::vector<Use> uses;
    uses.swap(uses_);
    used_ = 0;
    if (stopped != nothing_stopped)
      forget();
    else
      for (const Use& use : uses) use(found.data() + stops);
    return stopped;
  }

 private:
  void forget() {
    double none = 0;
    std::memcpy(&none, &nothing_stopped, sizeof none);
    values_.upload(&none, 0, stops);
  }

  std::size_t used_ = 0;
  DeviceArray<double> values_;
  std::vector<Use> uses_;
};

}  // namespace mpm::device
