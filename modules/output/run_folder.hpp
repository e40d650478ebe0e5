// The folder that holds everything one run leaves behind.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "support/file_descriptor.hpp"

namespace mpm::output {

/// The wanted folder may not be used: it holds something else than a run. A mistake of the caller: exit code 2.
class FolderRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Nothing a person made is ever overwritten: an earlier run is replaced when asked for, file by file of those that a run
/// writes, and anything else is refused.
class RunFolder {
 public:
  /// Whether there is a run at this path, finished or not: a folder with a manifest.json.
  static bool holds_run(const std::filesystem::path& path);

  /// Makes the folder and those above it. Write manifest.json early, so that a killed run is known as a run. Throws
  /// FolderRefused, with a remedy, when the path is a file or a folder that holds files; MachineError when the disk
  /// refuses.
  static RunFolder create(const std::filesystem::path& path);

  /// Removes what a run wrote here, by the names that runs use, and keeps manifest.json, to be overwritten, and all else.
  /// Only for who holds the lock. Throws FolderRefused when there is no run; MachineError when the disk refuses.
  static RunFolder replace(const std::filesystem::path& path);

  /// Takes an existing run as it is, to resume it or to draw its figures again. Throws FolderRefused when there is no
  /// run at this path.
  static RunFolder open(const std::filesystem::path& path);

  const std::filesystem::path& root() const { return root_; }

  /// The folder of figures, as each subfolder below, is made at first use. Throws MachineError.
  std::filesystem::path figures() const { return subfolder("figures"); }
  std::filesystem::path frames() const { return subfolder("frames"); }
  std::filesystem::path vtk() const { return subfolder("vtk"); }
  std::filesystem::path particles() const { return subfolder("particles"); }
  std::filesystem::path checkpoint() const { return subfolder("checkpoint"); }

  /// Removes what killed processes left half-written (".*.tmp"), in all subfolders. Only for who holds the lock.
  void remove_temporary_files() const;

  /// Writes root()/name, indented by two, whole or not at all. NaN and infinity become null. Throws MachineError.
  void write_json(std::string_view name, const nlohmann::ordered_json& value) const;

  /// Writes root()/name, whole or not at all. Throws MachineError.
  void write_text(std::string_view name, std::string_view text) const;

 private:
  explicit RunFolder(std::filesystem::path root) : root_(std::move(root)) {}
  std::filesystem::path subfolder(const char* name) const;
  void remove(const char* name) const;

  std::filesystem::path root_;  ///< absolute, so that a later change of the working folder cannot move it
};

/// A lock held by the one program that writes to a run folder; the system lets go of it when that program ends, however
/// it ends. It leaves no file.
class FolderLock {
 public:
  /// Takes the lock. Throws FolderRefused when another program holds it. On a file system without locks there is none.
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  support::FileDescriptor folder_;
};

}  // namespace mpm::output
