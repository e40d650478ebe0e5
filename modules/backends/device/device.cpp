#include "backends/device/device.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

namespace mpm::device {
namespace {

constexpr const char* go_on =
    "; what was written is kept, and a run with a checkpoint goes on with --resume, also with --device host";

/// What to do about a result.
std::string remedy_for(DriverResult result) {
  switch (result) {
    case driver_out_of_memory:
      return "; use larger cells, fewer particles a cell, --set /precision=float, a device with more memory, or "
             "--backend cpu";
    case driver_no_device:
    case driver_invalid_device:
      return "; see mpm list --devices for the devices of this machine, or use --backend cpu";
    case driver_no_binary_for_device:
    case driver_unsupported_ptx_version:
    case driver_system_driver_mismatch:
      return "; the driver is older than the compiler that made this program: install a newer driver or an older "
             "NVRTC (CUDA_PATH), or use --backend cpu";
    default:
      return go_on;
  }
}

std::string name_of_result(const Driver& driver, DriverResult result) {
  const char *name = nullptr, *text = nullptr;
  driver.cuGetErrorName(result, &name), driver.cuGetErrorString(result, &text);
  return (name ? std::string(name) : "error " + std::to_string(result)) + (text ? ", " + std::string(text) : "");
}

void check_driver(const Driver& driver, DriverResult result, const std::string& doing) {
  if (result != driver_success)
    throw DeviceError("the driver failed " + doing + ": " + name_of_result(driver, result) + remedy_for(result));
}

std::string name_of_device(const Driver& driver, DeviceNumber device) {
  std::array<char, 256> name{};
  check_driver(driver, driver.cuDeviceGetName(name.data(), static_cast<int>(name.size()), device), "to name a device");
  return name.data();
}

std::string architecture_of(const Driver& driver, DeviceNumber device) {
  int major = 0, minor = 0;
  check_driver(driver, driver.cuDeviceGetAttribute(&major, attribute_capability_major, device),
               "to tell a device's architecture");
  check_driver(driver, driver.cuDeviceGetAttribute(&minor, attribute_capability_minor, device),
               "to tell a device's architecture");
  return "sm_" + std::to_string(major) + std::to_string(minor);
}

int count_devices(const Driver& driver) {
  int count = 0;
  check_driver(driver, driver.cuDeviceGetCount(&count), "to count devices");
  return count;
}

}  // namespace

std::string bytes_in_words(double bytes) {
  const char* const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  while (bytes >= 1024 && unit + 1 < std::size(units)) bytes /= 1024, ++unit;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), unit == 0 ? "%.0f %s" : "%.3g %s", bytes, units[unit]);
  return text.data();
}

Device::Device(const Driver& driver, int number) : driver_(driver), number_(number) {
  const int count = count_devices(driver);
  if (count == 0) throw DeviceError("the driver lists no device" + remedy_for(driver_no_device));
  if (number < 0 || number >= count)
    throw DeviceError("there is no device " + std::to_string(number) + ": the driver lists " + std::to_string(count) +
                      (count == 1 ? " device, number 0" : " devices, from number 0") +
                      remedy_for(driver_invalid_device));
  check_driver(driver, driver.cuDeviceGet(&device_, number), "to open device " + std::to_string(number));
  name_ = name_of_device(driver, device_);
  check(driver_.cuDevicePrimaryCtxRetain(&context_, device_), "to open it");
  try {
    make_current();
    check(driver_.cuStreamCreate(&stream_, 0), "to make a stream");
  } catch (...) {
    driver_.cuDevicePrimaryCtxRelease_v2(device_);
    throw;
  }
}

Device::~Device() {
  // A device that is lost refuses all of this; its memory goes with the context.
  driver_.cuCtxSetCurrent(context_);
  for (const Timed& timed : timed_) driver_.cuEventDestroy_v2(timed.start), driver_.cuEventDestroy_v2(timed.end);
  for (EventHandle event : events_) driver_.cuEventDestroy_v2(event);
  if (module_) driver_.cuModuleUnload(module_);
  driver_.cuStreamDestroy_v2(stream_);
  driver_.cuDevicePrimaryCtxRelease_v2(device_);
}

void Device::check(DriverResult result, const std::string& doing) const {
  if (result == driver_success) return;
  throw DeviceError("device " + std::to_string(number_) + " (" + name_ + ") failed " + doing + ": " +
                    name_of_result(driver_, result) + remedy_for(result));
}

void Device::make_current() const {
  check(driver_.cuCtxSetCurrent(context_), "to be used by this thread");
}

std::uint64_t Device::free_bytes() const {
  make_current();
  std::size_t free = 0, total = 0;
  check(driver_.cuMemGetInfo_v2(&free, &total), "to tell its free memory");
  return free;
}

std::string Device::architecture() const {
  return architecture_of(driver_, device_);
}

int Device::multiprocessors() const {
  int count = 0;
  check(driver_.cuDeviceGetAttribute(&count, attribute_multiprocessors, device_), "to tell its multiprocessors");
  return count;
}

void Device::load(const std::string& image, const std::string& program) {
  make_current();
  program_ = program;
  int version = 0;
  check(driver_.cuDriverGetVersion(&version), "to tell its driver's version");
  check(driver_.cuModuleLoadData(&module_, image.data()),
        "to load the program \"" + program + "\" (the driver is of CUDA " + std::to_string(version / 1000) + "." +
            std::to_string(version % 1000 / 10) + ")");
}

DevicePointer Device::allocate(std::size_t bytes, const std::string& what) {
  make_current();
  DevicePointer pointer = 0;
  const DriverResult result = driver_.cuMemAlloc_v2(&pointer, bytes);
  if (result == driver_out_of_memory)
    check(result, "to give " + bytes_in_words(static_cast<double>(bytes)) + " to " + what + ", with " +
                      bytes_in_words(static_cast<double>(free_bytes())) + " free");
  check(result, "to give memory to " + what);
  return pointer;
}
void Device::free(DevicePointer pointer) noexcept {
  driver_.cuCtxSetCurrent(context_);
  driver_.cuMemFree_v2(pointer);
}

void Device::copy_in(DevicePointer to, const void* from, std::size_t bytes) {
  make_current();
  ++host_copies_;
  check(driver_.cuMemcpyHtoDAsync_v2(to, from, bytes, stream_), "to take a copy");
}
void Device::read(void* to, DevicePointer from, std::size_t bytes) {
  make_current();
  ++host_copies_;
  landing_.resize(std::max(landing_.size(), bytes));
  check(driver_.cuMemcpyDtoHAsync_v2(landing_.data(), from, bytes, stream_), "to give a copy");
  try {
    synchronise();
  } catch (...) {
    abandoned_.push_back(std::move(landing_));
    landing_.clear();
    throw;
  }
  std::memcpy(to, landing_.data(), bytes);
}
void Device::copy(DevicePointer to, DevicePointer from, std::size_t bytes) {
  make_current();
  check(driver_.cuMemcpyDtoDAsync_v2(to, from, bytes, stream_), "to copy");
}
void Device::fill(DevicePointer to, unsigned char byte, std::size_t bytes) {
  make_current();
  check(driver_.cuMemsetD8Async(to, byte, bytes, stream_), "to fill memory");
}

void Device::begin_capture() {
  make_current();
  check(driver_.cuStreamBeginCapture_v2(stream_, capture_of_thread), "to begin a graph");
}
GraphExecHandle Device::end_capture() {
  make_current();
  GraphHandle graph = nullptr;
  GraphExecHandle made = nullptr;
  check(driver_.cuStreamEndCapture(stream_, &graph), "to end a graph");
  const DriverResult result = driver_.cuGraphInstantiateWithFlags(&made, graph, 0);
  driver_.cuGraphDestroy(graph);
  check(result, "to make a graph ready");
  return made;
}
void Device::abandon_capture() noexcept {
  GraphHandle graph = nullptr;
  if (driver_.cuStreamEndCapture(stream_, &graph) == driver_success) driver_.cuGraphDestroy(graph);
}
void Device::launch(GraphExecHandle graph) {
  make_current();
  check(driver_.cuGraphLaunch(graph, stream_), "to launch a graph");
}
void Device::free(GraphExecHandle graph) noexcept {
  driver_.cuCtxSetCurrent(context_);
  driver_.cuGraphExecDestroy(graph);
}

FunctionHandle Device::function(const std::string& phase) {
  FunctionHandle& found = functions_[phase];
  if (found) return found;
  const DriverResult result = driver_.cuModuleGetFunction(&found, module_, ("mpm_" + phase).c_str());
  if (result == driver_not_found)
    throw std::logic_error("the composition " + program_ + " has no phase \"" + phase + "\"");
  check(result, "to find the phase \"" + phase + "\"");
  return found;
}

void Device::launch(const std::string& phase, const void* arguments, std::size_t bytes, int teams, int lanes) {
  make_current();
  FunctionHandle entry = function(phase);
  if (teams < 1) return;
  void* block[] = {launch_parameter_buffer, const_cast<void*>(arguments), launch_parameter_size, &bytes,
                   launch_parameter_end};
  if (measures_) {
    timed_.push_back({phase, event(), event()});
    check(driver_.cuEventRecord(timed_.back().start, stream_), "to record an event");
  }
  last_phase_ = phase;
  check(driver_.cuLaunchKernel(entry, static_cast<unsigned>(teams), 1, 1, static_cast<unsigned>(lanes), 1, 1, 0,
                               stream_, nullptr, block),
        "to launch the phase \"" + phase + "\"");
  if (measures_) check(driver_.cuEventRecord(timed_.back().end, stream_), "to record an event");
}

void Device::synchronise() {
  make_current();
  check(driver_.cuStreamSynchronize(stream_),
        last_phase_.empty() ? "to copy" : "in the work up to the phase \"" + last_phase_ + "\"");
  for (const Timed& timed : timed_) {
    float milliseconds = 0;
    check(driver_.cuEventElapsedTime(&milliseconds, timed.start, timed.end), "to tell a time");
    seconds_[timed.phase] += 1e-3 * static_cast<double>(milliseconds);
    events_.push_back(timed.start), events_.push_back(timed.end);
  }
  timed_.clear();
}

EventHandle Device::event() {
  EventHandle event = nullptr;
  if (events_.empty())
    check(driver_.cuEventCreate(&event, 0), "to make an event");
  else
    event = events_.back(), events_.pop_back();
  return event;
}

void Device::measure(bool on) {
  synchronise();
  measures_ = on;
  if (on) seconds_.clear();
}

std::vector<DeviceDescription> devices_of(const Driver& driver) {
  std::vector<DeviceDescription> all;
  for (int number = 0; number < count_devices(driver); ++number) {
    DeviceNumber device = 0;
    check_driver(driver, driver.cuDeviceGet(&device, number), "to open device " + std::to_string(number));
    std::size_t bytes = 0;
    check_driver(driver, driver.cuDeviceTotalMem_v2(&bytes, device), "to tell a device's memory");
    all.push_back({number, name_of_device(driver, device), architecture_of(driver, device), bytes});
  }
  return all;
}

}  // namespace mpm::device
