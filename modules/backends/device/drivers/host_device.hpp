#pragma once
// The host-run device compiles a composition by the system's C++ compiler, without system headers, and runs it on the
// CPU. It stands in for a GPU in tests, as the text is the very same.

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "backends/device/compose.hpp"
#include "backends/device/kernels/arguments.hpp"

namespace mpm::device {

/// Thrown when a compiler is missing or refuses a composition; the message names the composition and holds the
/// compiler's words.
class CompilerError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct HostCompiler {
  std::string program = "c++";  ///< GCC or Clang, found on PATH
  std::vector<std::string> options{"-O1"};

  /// All options that are handed to the program, but no files.
  std::vector<std::string> all_options() const;
};

/// The way in which teams run on the host.
struct TeamShape {
  int lanes = 32;
  bool backwards = false;  ///< lanes and teams run in reverse order: results must agree to the rounding of sums
};

/// The phases of one composition, loaded into this process.
class HostDevice {
 public:
  /// Compiles into a scratch folder, which is removed before this returns. Throws CompilerError.
  explicit HostDevice(const Composition& composition, const HostCompiler& compiler = {});

  const std::string& name() const { return name_; }

  /// Runs the entry "mpm_<phase>" with that many teams. Throws std::logic_error when the composition has no such entry.
  template <class T>
  void run(const std::string& phase, const Arguments<T>& arguments, int teams, const TeamShape& team) const {
    using Entry = void (*)(const Arguments<T>*, int teams, int lanes, bool backwards);
    reinterpret_cast<Entry>(entry(phase))(&arguments, teams, team.lanes, team.backwards);
  }

 private:
  void* entry(const std::string& phase) const;

  std::string name_;
  std::shared_ptr<void> library_;
};

}  // namespace mpm::device
