#include "support/files.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <atomic>
#include <cstring>
#include <sstream>

#include "support/file_descriptor.hpp"

namespace mpm::support {
namespace {

namespace fs = std::filesystem;

const char* remedy_for(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space there, or choose another folder with --out";
    case EFBIG:
      return "raise the limit on file size (ulimit -f), or write less often";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to with --out";
    case ENOTDIR:
      return "a part of this path is a file, not a folder: choose another with --out";
    case EISDIR:
      return "a folder has this name: move it aside, or choose another with --out";
    case ENOENT:
      return "the file or its folder does not exist: check the path, or create the folder";
    case ENAMETOOLONG:
      return "choose a shorter name";
    case EMFILE:
    case ENFILE:
      return "too many files are open: raise the limit (ulimit -n), or run fewer jobs at once";
    default:
      return "check that the disk is mounted and healthy, then run again";
  }
}

/// The process id and a counter keep parallel runs and threads apart; the leading dot hides what a killed process
/// leaves.
fs::path temporary_name(const fs::path& path) {
  static std::atomic<unsigned> counter{0};
  std::ostringstream name;
  name << '.' << path.filename().string() << '.' << ::getpid() << '-' << counter.fetch_add(1) << ".tmp";
  return path.parent_path() / name.str();
}

struct TemporaryFile {
  fs::path path;
  FileDescriptor file;
};

TemporaryFile open_temporary(const fs::path& target) {
  for (;;) {
    fs::path path = temporary_name(target);
    FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.valid()) return {std::move(path), std::move(file)};
    if (errno != EEXIST) throw MachineError::from_errno("write", target, errno);
  }
}

/// Syncs the folder, which makes the rename itself durable; a file system that cannot has lost nothing that was
/// promised.
void sync_folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const FileDescriptor handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (handle.valid()) ::fsync(handle.number());
}

}  // namespace

MachineError MachineError::from_errno(std::string_view action, const fs::path& path, int error) {
  std::ostringstream message;
  message << "cannot " << action << " " << path.string() << ": " << std::strerror(error) << "; " << remedy_for(error);
  return MachineError(message.str());
}

void write_atomically(const fs::path& path, std::string_view bytes, Durability durability) {
  write_atomically(path, {bytes}, durability);
}

void write_atomically(const fs::path& path, std::initializer_list<std::string_view> pieces, Durability durability) {
  TemporaryFile temporary = open_temporary(path);
  int error = 0;
  for (const std::string_view piece : pieces)
    if (error == 0) error = temporary.file.write_all(piece);
  if (durability == Durability::on_disk && error == 0 && ::fsync(temporary.file.number()) != 0) error = errno;
  const int close_error = temporary.file.close();
  if (error == 0) error = close_error;
  if (error == 0 && std::rename(temporary.path.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.path.c_str());
    throw MachineError::from_errno("write", path, error);
  }
  if (durability == Durability::on_disk) sync_folder_of(path);
}

std::string read_file(const fs::path& path) {
  std::string bytes;
  read_in_pieces(path, [&](std::string_view piece) { bytes.append(piece); });
  return bytes;
}

void read_in_pieces(const fs::path& path, const std::function<void(std::string_view)>& consume) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid()) throw MachineError::from_errno("read", path, errno);
  std::string buffer(1 << 16, '\0');
  for (;;) {
    const ssize_t count = ::read(file.number(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw MachineError::from_errno("read", path, errno);
    if (count == 0) return;
    consume(std::string_view(buffer).substr(0, static_cast<std::size_t>(count)));
  }
}

fs::path with_suffix(const fs::path& stem, std::string_view extension) {
  fs::path path = stem;
  path += extension;
  return path;
}

}  // namespace mpm::support
