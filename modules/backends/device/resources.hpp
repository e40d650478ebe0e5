#pragma once
// What a kernel takes of a GPU, as its compiler says: figures of compile time, for which no device is needed.

#include <string>
#include <string_view>
#include <vector>

#include "backends/device/compose.hpp"

namespace mpm::device {

/// The lanes of a team on a GPU.
inline constexpr int lanes_of_gpu = 128;

struct KernelResources {
  std::string kernel;     ///< name of the phase, "scatter"
  int registers = 0;      ///< of a lane
  int shared_bytes = 0;   ///< of a team
  int stack_bytes = 0;    ///< of a lane: arrays that are indexed by what the compiler does not know, and spills
  int spilled_bytes = 0;  ///< bytes stored and loaded again because registers did not suffice

  bool spills() const { return spilled_bytes > 0; }
};

/// Reads what ptxas says with --ptxas-options=-v of every kernel, in its order. Throws std::invalid_argument where a
/// kernel's registers are not said: the compiler's words have changed.
std::vector<KernelResources> resources_in(std::string_view log);

/// What limits how many teams a multiprocessor holds (CUDA C++ Programming Guide, technical specifications by compute
/// capability).
struct Multiprocessor {
  std::string architecture;  ///< "sm_90"
  int warps = 0, blocks = 0, registers = 0, shared_bytes = 0;
};
/// The architectures that figures are given for.
const std::vector<Multiprocessor>& multiprocessors();

/// The ceiling on occupancy: the warps of a multiprocessor that teams of so many lanes can fill, as a share of all.
double occupancy(const KernelResources& kernel, const Multiprocessor& processor, int lanes = lanes_of_gpu);

}  // namespace mpm::device
