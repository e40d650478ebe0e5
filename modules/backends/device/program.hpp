#pragma once
// Machine code of a composition, made by the compiler that goes with a driver or taken from the cache.

#include <filesystem>
#include <string>

#include "backends/device/make_device_backend.hpp"

namespace mpm::device {

/// Whatever compiles a composition for a driver.
class Compiler {
 public:
  virtual ~Compiler() = default;
  /// Its name, version and options: all that the machine code of a composition depends on beside its text.
  virtual std::string identity(const std::string& architecture) const = 0;
  /// Throws CompilerError with the compiler's words.
  virtual std::string compile(const Composition& composition, const std::string& architecture) const = 0;
};

/// Makes a composition's program, or takes it from the cache; says on standard error that it compiles, as that takes
/// seconds. Throws CompilerError, to whose message it adds the files of the plugins that the compiler names.
std::string program_of(const Composition& composition, const Compiler& compiler, const std::string& architecture);

/// What `--device` names: "host", or the number of a device of libcuda; empty for what MPM_DEVICE says, else 0. Throws
/// DeviceError for another word, and where NVIDIA's driver or compiler is missing: it says where they were looked for.
DeviceSetup setup_for(const std::string& device);

/// The host's device number 0 with programs that tell it of every access (drivers/race_recorder.hpp).
DeviceSetup recording_setup();

/// Whether this is the host's device, by the word or by MPM_DEVICE.
bool is_host_device(const std::string& device);

/// Whether a word may stand after --device.
bool names_device(const std::string& word);

/// The devices of this machine in words, one a line, those that are missing too: for `mpm list --devices`.
std::string device_list();

}  // namespace mpm::device
