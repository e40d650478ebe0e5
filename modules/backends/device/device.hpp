#pragma once
// One device in use: its memory, one stream of copies and launches in order, and one program, all through a driver's
// table. Whatever the driver refuses becomes a DeviceError that says what was asked of which device and what to do.

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "backends/device/drivers/driver.hpp"
#include "backends/device/kernels/arguments.hpp"
#include "support/files.hpp"

namespace mpm::device {

/// Thrown when a device is missing, too small, lost or refuses its work. It maps to exit code 5.
class DeviceError : public support::MachineError {
  using support::MachineError::MachineError;
};

/// A size in words: "1.5 GiB".
std::string bytes_in_words(double bytes);

class Device {
 public:
  /// Opens a device by its number. Throws DeviceError where there is none of that number.
  Device(const Driver& driver, int number);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const std::string& name() const { return name_; }  ///< as the driver calls it
  std::uint64_t free_bytes() const;
  int multiprocessors() const;
  /// The architecture of machine code, "sm_90".
  std::string architecture() const;

  /// Loads a program. `program` names it in messages. Throws DeviceError.
  void load(const std::string& image, const std::string& program);

  /// Memory, whose bytes have any value. `what` names it in the message of a DeviceError.
  DevicePointer allocate(std::size_t bytes, const std::string& what);
  void free(DevicePointer pointer) noexcept;

  // What follows waits in the stream. Sources of copies in may be changed at once.
  void copy_in(DevicePointer to, const void* from, std::size_t bytes);
  void copy(DevicePointer to, DevicePointer from, std::size_t bytes);
  void fill(DevicePointer to, unsigned char byte, std::size_t bytes);

  /// Runs the entry "mpm_<phase>" with so many teams; none is no launch. Throws std::logic_error where the program has
  /// no such entry.
  template <class T>
  void launch(const std::string& phase, const Arguments<T>& arguments, int teams, int lanes) {
    static_assert(sizeof(Arguments<T>) <= 4096, "a kernel takes at most 4096 bytes of parameters");
    launch(phase, &arguments, sizeof arguments, teams, lanes);
  }

  /// Begins to collect fills, copies on the device and launches in a graph instead of running them. Nothing may be copied
  /// from or to the host, allocated or waited for until the graph is made.
  void begin_capture();
  /// Makes the graph of what was collected. Throws DeviceError where something came that it cannot hold.
  GraphExecHandle end_capture();
  /// Ends a capture that nobody wants any more.
  void abandon_capture() noexcept;
  /// Runs a graph's work once.
  void launch(GraphExecHandle graph);
  void free(GraphExecHandle graph) noexcept;
  /// The copies from and to the host so far.
  long host_copies() const { return host_copies_; }
  bool measures() const { return measures_; }

  /// Waits for a copy out. Throws DeviceError as `synchronise` does.
  void read(void* to, DevicePointer from, std::size_t bytes);

  /// Waits for all of it. Throws DeviceError where a launch failed or the device is lost.
  void synchronise();

  /// Begins or ends measuring phases by events of the device, and the seconds since it began.
  void measure(bool on);
  const std::map<std::string, double>& seconds() const { return seconds_; }

 private:
  struct Timed {
    std::string phase;
    EventHandle start, end;
  };

  void launch(const std::string& phase, const void* arguments, std::size_t bytes, int teams, int lanes);
  FunctionHandle function(const std::string& phase);
  EventHandle event();
  void check(DriverResult result, const std::string& doing) const;
  void make_current() const;

  const Driver& driver_;
  int number_;
  DeviceNumber device_ = 0;
  ContextHandle context_ = nullptr;
  StreamHandle stream_ = nullptr;
  ModuleHandle module_ = nullptr;
  std::string name_, program_, last_phase_;
  std::map<std::string, FunctionHandle> functions_;
  long host_copies_ = 0;
  bool measures_ = false;
  std::vector<Timed> timed_;
  std::vector<EventHandle> events_;  ///< those free for use
  std::map<std::string, double> seconds_;
  std::vector<unsigned char> landing_;                 ///< where copies out arrive
  std::vector<std::vector<unsigned char>> abandoned_;  ///< of copies that were never waited for, and may still arrive
};

/// What a driver's devices are, for `mpm list --devices`.
struct DeviceDescription {
  int number = 0;
  std::string name, architecture;
  std::uint64_t bytes = 0;
};
/// All devices of a driver. Throws DeviceError.
std::vector<DeviceDescription> devices_of(const Driver& driver);

/// An array on a device. It may be moved, and given another length, which leaves its values undefined.
template <class T>
class DeviceArray {
 public:
  /// `what` names it in messages.
  DeviceArray(Device& device, std::string what, std::size_t count = 0) : device_(&device), what_(std::move(what)) {
    resize(count);
  }
  ~DeviceArray() { release(); }
  DeviceArray(DeviceArray&& other) noexcept
      : device_(other.device_),
        what_(std::move(other.what_)),
        pointer_(std::exchange(other.pointer_, 0)),
        count_(std::exchange(other.count_, 0)),
        room_(std::exchange(other.room_, 0)) {}
  DeviceArray& operator=(DeviceArray&&) = delete;

  std::size_t count() const { return count_; }
  std::uint64_t bytes() const { return room_ * sizeof(T); }
  /// The device's address, which the host must not follow; null where there is nothing.
  // NOLINTNEXTLINE(performance-no-int-to-ptr): CUDA gives addresses as numbers, kernels take pointers
  T* data() const { return reinterpret_cast<T*>(static_cast<std::uintptr_t>(pointer_)); }

  void resize(std::size_t count) {
    if (count > room_) {
      release();
      pointer_ = device_->allocate(count * sizeof(T), what_);
      room_ = count;
    }
    count_ = count;
  }
  void upload(const std::vector<T>& values) {
    resize(values.size());
    upload(values.data(), 0, values.size());
  }
  void upload(const T* values, std::size_t first, std::size_t count) {
    if (count > 0) device_->copy_in(pointer_ + first * sizeof(T), values, count * sizeof(T));
  }
  void clear() { fill(0); }
  void fill(unsigned char byte, std::size_t first, std::size_t count) const {
    if (count > 0) device_->fill(pointer_ + first * sizeof(T), byte, count * sizeof(T));
  }
  void fill(unsigned char byte) const { fill(byte, 0, count_); }

  /// Waits for the values.
  std::vector<T> download() const { return download(0, count_); }
  std::vector<T> download(std::size_t first, std::size_t count) const {
    std::vector<T> values(count);
    if (count > 0) device_->read(values.data(), pointer_ + first * sizeof(T), count * sizeof(T));
    return values;
  }
  /// Copies within the array, on the device.
  void copy(std::size_t to, std::size_t from, std::size_t count) {
    if (count > 0) device_->copy(pointer_ + to * sizeof(T), pointer_ + from * sizeof(T), count * sizeof(T));
  }

 private:
  void release() {
    if (pointer_) device_->free(pointer_);
    pointer_ = 0, room_ = count_ = 0;
  }

  Device* device_;
  std::string what_;
  DevicePointer pointer_ = 0;
  std::size_t count_ = 0, room_ = 0;
};

}  // namespace mpm::device
