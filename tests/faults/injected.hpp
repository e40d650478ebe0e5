#pragma once
// The fault that the program of this suite has now. suite.cmake writes the faults into copies of the backends' texts.

namespace mpm::test {

/// The kernels of the host-run device ask mpm_fault_now for its number.
enum class Fault : int {
  none = 0,
  wall = 1,     ///< conditions give 1 % less than they record
  contact = 2,  ///< half of the contact impulse is recorded
  scatter = 3,  ///< what one node was given is lost, on the device by one particle
  filter = 4,   ///< the velocity after the filter is larger by 1e-3
  gather = 5,   ///< particles take 0.1 % less velocity than they gather
  strain = 6    ///< particles strain by 1 % less than they gather
};
inline Fault injected = Fault::none;

}  // namespace mpm::test
