// Files that are either whole or absent, and the one error type for a machine that fails.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mpm::output {

/// The machine failed (disk full, folder unwritable, helper program crashed). Maps to exit code 5.
/// what() names the path, the cause and what to do about it.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  /// Builds "cannot ACTION PATH: CAUSE; REMEDY" from an errno value.
  static MachineError from_errno(std::string_view action, const std::filesystem::path& path, int error);
};

/// Replaces the file at `path` by `bytes`: written under a unique name in the same folder, synced, renamed.
/// Readers see the old file or the new one, never a part. The folder must exist.
/// @throws MachineError; the old file is then untouched and the temporary one removed.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);
/// The same for pieces that are written one after another, so that large ones need not be joined in memory.
void write_atomically(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// The whole file as bytes. @throws MachineError when it cannot be opened or read.
std::string read_file(const std::filesystem::path& path);

/// SHA-256 of the file's bytes, 64 lower-case hexadecimal digits. @throws MachineError when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

/// SHA-256 of `bytes`, 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);
/// Of the pieces as if they were joined.
std::string sha256(std::initializer_list<std::string_view> pieces);

}  // namespace mpm::output
