#pragma once
// The system's C++ compiler turns a composition into a program of the host driver: a shared library, whose bytes are
// handed to cuModuleLoadData as those of a cubin are. The text is the very same that a GPU's compiler sees.

#include <string>
#include <vector>

#include "backends/device/compose.hpp"
#include "support/files.hpp"

namespace mpm::device {

/// Thrown when a compiler is missing or refuses a composition; the message names the composition and holds the
/// compiler's words, which name plugin, file and line.
class CompilerError : public support::MachineError {
  using support::MachineError::MachineError;
};

/// Thrown when there is no such compiler.
class MissingCompiler : public CompilerError {
  using CompilerError::CompilerError;
};

struct HostCompiler {
  std::string program = "c++";  ///< GCC or Clang, found on PATH
  std::vector<std::string> options{"-O1"};
  bool records = false;  ///< the program tells the driver of every access (drivers/race_recorder.hpp), which is slow

  /// All options that are handed to the program for compiling, but no files.
  std::vector<std::string> all_options() const;

  /// The bytes of the shared library. It is made in a scratch folder, which is removed before this returns. Throws
  /// CompilerError. Several threads may call it at once.
  std::string compile(const Composition& composition) const;

  /// What the program says of its version, one line. Throws CompilerError where there is none.
  std::string version() const;
};

}  // namespace mpm::device
