#pragma once
// The host as a driver: devices without a GPU, behind the functions that libcuda has. CI runs the launch layer on them,
// and anyone may (--device host). They are stricter than a GPU where that shows mistakes:
//  - A device pointer is no host address: following it ends the process. Kernels see the memory behind it, as pointers
//    are translated in launch parameters and in what is copied to the device.
//  - Copies, fills and launches wait in their stream until something synchronises it; then they run in order.
//  - New memory holds bytes 0xff: floating-point numbers start as NaN.
//  - A launch that is handed a host address fails with CUDA_ERROR_ILLEGAL_ADDRESS.
// A module's image is a shared library (drivers/host_compiler.hpp).

#include <cstdint>
#include <string>
#include <vector>

#include "backends/device/drivers/driver.hpp"
#include "backends/device/drivers/race_recorder.hpp"

namespace mpm::device {

/// What one device of the host driver is like.
struct HostDevice {
  std::string name = "host";
  std::uint64_t memory = 0;  ///< bytes; 0: as many as the machine has
  /// The order of lanes and teams: 0 upwards, 1 downwards, any other number shuffles by it as a seed. Results must agree
  /// to the rounding of sums.
  unsigned order = 0;
  bool records = false;  ///< accesses of programs that tell them (HostCompiler::records) are looked at
};

/// The table of the host driver. It is the same for the whole process, as libcuda's is.
const Driver& host_driver();

/// Replaces the devices of the process; at first there is one. Throws std::logic_error while any is in use.
void set_host_devices(std::vector<HostDevice> devices);

/// Lets the `call`-th call from now (from 1) of a function, "cuLaunchKernel", return `result`. From a result that says
/// that the device is lost (CUDA_ERROR_ILLEGAL_ADDRESS, CUDA_ERROR_LAUNCH_FAILED and the like, after which no work of CUDA
/// goes on in a process, and CUDA_ERROR_DEVICE_UNAVAILABLE) every later call of that context returns it too, as with
/// libcuda. Throws std::logic_error where no function is called so.
void fail_on_host(const std::string& function, long call, DriverResult result);
/// Forgets the failures that have not come yet.
void forget_failures_on_host();

/// The number of calls of a function so far.
long calls_on_host(const std::string& function);
/// The bytes that are allocated on a device now; 0 while nobody uses it.
std::uint64_t bytes_on_host(int device);

/// The bytes that were never freed on devices whose last user has left, of the whole process: a driver takes them back
/// with the context, and hides by that that they were forgotten. Lost devices do not count.
std::uint64_t bytes_left_on_host();
/// The bytes that were copied between the host and its devices so far, both ways.
std::uint64_t bytes_copied_on_host();

/// What a device that records has seen since set_host_devices. Throws std::logic_error where it has not been used.
RaceRecorder& recorder_on_host(int device);

}  // namespace mpm::device
