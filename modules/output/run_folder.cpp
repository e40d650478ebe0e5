#include "output/run_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <string>
#include <vector>

#include "support/files.hpp"
#include "support/film_formats.hpp"

namespace mpm::output {
namespace {

namespace fs = std::filesystem;

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

fs::path without_trailing_slash(const fs::path& path) {
  const fs::path absolute = fs::weakly_canonical(fs::absolute(path));
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

/// All that a run writes but its manifest and its film, by name.
constexpr const char* results[] = {"experiment.json", "plan.json", "summary.json", "metrics.csv", "report.html",
                                   "figures",         "frames",    "vtk",          "particles",   "checkpoint"};

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw support::MachineError::from_errno("create the folder", folder, error.value());
}

void refuse_other_contents(const fs::path& root) {
  if (!fs::is_directory(root)) throw FolderRefused(root.string() + " is a file; choose another folder with --out");
  if (holds_no_file(root)) return;
  throw FolderRefused(root.string() +
                      (RunFolder::holds_run(root) ? " holds an earlier run; replace it with --replace"
                                                  : " holds files that are not an earlier run (no "
                                                    "manifest.json), and none of them will be touched; empty "
                                                    "it") +
                      ", or choose another folder with --out");
}

}  // namespace

bool RunFolder::holds_run(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path / "manifest.json", ignored);
}

RunFolder RunFolder::create(const fs::path& path) {
  try {
    const fs::path root = without_trailing_slash(path);
    if (fs::exists(root)) refuse_other_contents(root);
    make_folder(root);
    return RunFolder(root);
  } catch (const fs::filesystem_error& error) {
    throw support::MachineError::from_errno("use the folder", path, error.code().value());
  }
}

RunFolder RunFolder::replace(const fs::path& path) {
  const RunFolder folder = open(path);
  // The summary goes first and the manifest stays: what is left when this is interrupted is an unfinished run.
  for (const char* name : {"summary.json", "report.html"}) folder.remove(name);
  for (const char* name : results) folder.remove(name);
  for (const std::string& format : support::film_formats()) folder.remove(("film." + format).c_str());
  folder.remove_temporary_files();
  return folder;
}

void RunFolder::remove(const char* name) const {
  std::error_code error;
  fs::remove_all(root_ / name, error);
  if (error) throw support::MachineError::from_errno("remove the earlier", root_ / name, error.value());
}

RunFolder RunFolder::open(const fs::path& path) {
  if (!holds_run(path)) {
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
