#pragma once
// What a scene will take of a device, for `mpm plan`: memory by field, and what each kernel takes as NVRTC compiles it.
// No device is needed, and nothing is run.

#include <nlohmann/json.hpp>

#include "backends/device/memory.hpp"
#include "backends/device/resources.hpp"

namespace mpm::device {

struct DevicePlan {
  std::string composition;             ///< name of the composition
  std::vector<std::string> bodies;     ///< names
  std::vector<TakenMemory> memory;     ///< of one particle of each body and of one node
  std::vector<std::string> kernels;    ///< phases of the composition
  std::string looks;                   ///< who asks nodes to look at particles where fields meet; empty for nobody
  std::string compiler;                ///< NVRTC with its version; empty where there is none
  std::string missing;                 ///< what is missing where there is no compiler
  Multiprocessor processor;            ///< of the architecture that was compiled for
  std::vector<KernelResources> taken;  ///< of each kernel; empty where there is no compiler

  double bytes_per_particle(int body) const;
  double bytes_per_node() const;
  std::string to_text() const;
  nlohmann::ordered_json to_json() const;
};

/// Composes the scene and compiles it for an architecture, "sm_90"; what the compiler says is kept in the cache of
/// programs. Throws ComposeError, and CompilerError where NVRTC refuses the composition.
DevicePlan device_plan(const Experiment& experiment, const Plan& plan, const Multiprocessor& processor);

/// Who asks nodes to look at particles where fields meet, as the plan names it; empty for nobody.
std::string who_looks_at_particles(const Experiment& experiment);

/// The architecture of a name. Throws std::invalid_argument with those that there are.
const Multiprocessor& multiprocessor(const std::string& architecture);

}  // namespace mpm::device
