// Files that are either whole or absent, and the one error type for a machine that fails.
#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mpm::support {

/// The machine failed (disk full, folder unwritable, helper program crashed). It maps to exit code 5. what() names the
/// path, the cause and what to do about it.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  /// Builds "cannot ACTION PATH: CAUSE; REMEDY" from an errno value.
  static MachineError from_errno(std::string_view action, const std::filesystem::path& path, int error);
};

/// Whether a file must outlive a crash of the machine, or only one of the program. Figures can be drawn again, and a
/// sync for each of hundreds of frames would take longer than drawing them.
enum class Durability { on_disk, of_program };

/// Replaces the file at `path` by `bytes`: written under a unique name in the same folder, synced where asked, renamed.
/// Readers see the old file or the new one, never a part. The folder must exist. Throws MachineError; the old file is
/// then untouched and the temporary one removed.
void write_atomically(const std::filesystem::path& path, std::string_view bytes,
                      Durability durability = Durability::on_disk);
/// Replaces the file by pieces that are written one after another, so that large ones need not be joined in memory.
void write_atomically(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces,
                      Durability durability = Durability::on_disk);

/// The whole file as bytes. Throws MachineError when it cannot be opened or read.
std::string read_file(const std::filesystem::path& path);

/// Hands the file to `consume` piece by piece, so that it is never held whole. Throws MachineError as read_file does.
void read_in_pieces(const std::filesystem::path& path, const std::function<void(std::string_view)>& consume);

/// The path stem + extension; unlike replace_extension it keeps a dot that belongs to the stem ("run_0.5").
std::filesystem::path with_suffix(const std::filesystem::path& stem, std::string_view extension);

}  // namespace mpm::support
