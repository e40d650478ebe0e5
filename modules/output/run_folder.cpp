#include "output/run_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <algorithm>
#include <string>
#include <vector>

#include "support/files.hpp"

namespace mpm::output {
namespace {

namespace fs = std::filesystem;

bool holds_a_run(const fs::path& folder) {
  return fs::is_regular_file(folder / "manifest.json");
}

/// Whether a file is one that write_atomically leaves when the process is killed in it.
bool is_temporary(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with('.') && name.ends_with(".tmp");
}

/// Empty subfolders and half-written files do not count: a run that was killed at its very start leaves those.
bool holds_no_file(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (is_temporary(entry.path()) && entry.is_regular_file()) continue;
    if (!entry.is_directory() || entry.is_symlink()) return false;
  }
  return true;
}

bool contains(const fs::path& folder, const fs::path& path) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

fs::path without_trailing_slash(const fs::path& path) {
  const fs::path absolute = fs::weakly_canonical(fs::absolute(path));
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

void move_aside(const fs::path& folder) {
  const FolderLock nobody_writes(folder);
  if (contains(folder, fs::current_path())) {
    throw FolderRefused(folder.string() +
                        " holds an earlier run, and the program was started inside it, so that it cannot be moved "
                        "aside; start from another folder, or choose another with --out");
  }
  for (int i = 1;; ++i) {
    const fs::path aside = folder.string() + "." + std::to_string(i);
    if (fs::exists(fs::symlink_status(aside))) continue;
    std::error_code error;
    fs::rename(folder, aside, error);
    if (!error) return;
    // Another program took this number between the check and the move.
    if (error != std::errc::directory_not_empty && error != std::errc::file_exists) {
      throw support::MachineError::from_errno("move aside the earlier run in", folder, error.value());
    }
  }
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw support::MachineError::from_errno("create the folder", folder, error.value());
}

void refuse_or_clear(const fs::path& root) {
  if (!fs::is_directory(root)) {
    throw FolderRefused(root.string() + " is a file; choose another folder with --out");
  }
  if (holds_a_run(root)) {
    move_aside(root);
  } else if (!holds_no_file(root)) {
    throw FolderRefused(root.string() +
                        " holds files that are not an earlier run (no manifest.json), and none of them will be "
                        "touched; empty it, or choose another folder with --out");
  }
}

}  // namespace

RunFolder RunFolder::create(const fs::path& path) {
  try {
    const fs::path root = without_trailing_slash(path);
    if (fs::exists(root)) refuse_or_clear(root);
    make_folder(root);
    return RunFolder(root);
  } catch (const fs::filesystem_error& error) {
    throw support::MachineError::from_errno("use the folder", path, error.code().value());
  }
}

RunFolder RunFolder::open(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path / "manifest.json", ignored)) {
    throw FolderRefused(path.string() + " holds no run (no manifest.json); give the folder that mpm run wrote");
  }
  return RunFolder(without_trailing_slash(path));
}

fs::path RunFolder::subfolder(const char* name) const {
  fs::path folder = root_ / name;
  make_folder(folder);
  return folder;
}

void RunFolder::remove_temporary_files() const {
  std::error_code error;
  std::vector<fs::path> left;
  for (const auto& entry : fs::recursive_directory_iterator(root_, error)) {
    if (entry.is_regular_file() && is_temporary(entry.path())) left.push_back(entry.path());
  }
  for (const fs::path& path : left) fs::remove(path, error);  // a file that stays costs room and nothing else
}

FolderLock::FolderLock(const fs::path& folder) : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_.valid() && ::flock(folder_.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw FolderRefused(folder.string() +
                        " is being written by another mpm that still runs; wait for it or end it, or choose another "
                        "folder with --out");
  }
}

void RunFolder::write_json(std::string_view name, const nlohmann::ordered_json& value) const {
  // A stray byte in a title is replaced, not refused: it must not cost the results of a run.
  write_text(name, value.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void RunFolder::write_text(std::string_view name, std::string_view text) const {
  support::write_atomically(root_ / name, text);
}

}  // namespace mpm::output
