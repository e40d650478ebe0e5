#pragma once
// The fault that the program of this suite has now. suite.cmake writes the faults into copies of the backends' texts.

namespace mpm::test {

/// The number of a device's fault is that of its macro MPM_FAULT.
enum class Fault : int {
  none = 0,
  wall = 1,     ///< conditions give 1 % less than they record
  contact = 2,  ///< half of the contact impulse is recorded
  scatter = 3,  ///< what one node was given is lost, on the device by one particle
  filter = 4    ///< the velocity after the filter is larger by 1e-3
};
inline Fault injected = Fault::none;

}  // namespace mpm::test
