#pragma once
// NVIDIA's compiler is found at run time by dlopen: nothing of CUDA is needed to build or to start the program.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backends/device/compose.hpp"

namespace mpm::device {

/// Machine code for one architecture, or the compiler's words.
struct Cubin {
  bool compiled = false;
  std::string code;  ///< an ELF image
  std::string log;   ///< errors and warnings, empty when there are none
};

class Nvrtc {
 public:
  /// Looks through the loader's path, CUDA_PATH and CUDA_HOME, and the usual folders. Returns nothing when it is not
  /// there; `why` then says where it was looked for and how to get it.
  static std::optional<Nvrtc> find(std::string& why);

  /// The version, "13.0", with the library's file.
  std::string version() const;

  /// All options for an architecture that is given as "sm_90".
  static std::vector<std::string> options(std::string_view architecture);

  /// Compiles to machine code of that architecture; with `verbose` the log says what each kernel takes of the device
  /// (backends/device/resources.hpp). Several threads may call it at once.
  Cubin compile(const Composition& composition, std::string_view architecture, bool verbose = false) const;

 private:
  struct Functions;
  std::shared_ptr<const Functions> functions_;
};

}  // namespace mpm::device
