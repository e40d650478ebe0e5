#include "support/files.hpp"

#include <fcntl.h>
#include <openssl/evp.h>
#include <unistd.h>
#include <atomic>
#include <cstring>
#include <memory>
#include <sstream>

#include "support/file_descriptor.hpp"

namespace mpm::output {
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

// The process id and a counter keep parallel runs and threads apart; the leading dot hides what a killed process
// leaves.
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

// Makes the rename itself durable; a file system that cannot sync a folder has lost nothing that was promised.
void sync_folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const FileDescriptor handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (handle.valid()) ::fsync(handle.number());
}

class Sha256 {
 public:
  Sha256() { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
  void add(const char* bytes, std::size_t count) { EVP_DigestUpdate(context_.get(), bytes, count); }
  std::string hex() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int length = 0;
    EVP_DigestFinal_ex(context_.get(), digest, &length);
    std::string text;
    for (unsigned int i = 0; i < length; ++i) {
      text += "0123456789abcdef"[digest[i] >> 4];
      text += "0123456789abcdef"[digest[i] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

// Opens and reads a file piece by piece, so that hashing never holds it whole.
template <typename Consume>
void read_in_pieces(const fs::path& path, Consume&& consume) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.valid()) throw MachineError::from_errno("read", path, errno);
  std::string buffer(1 << 16, '\0');
  for (;;) {
    const ssize_t count = ::read(file.number(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw MachineError::from_errno("read", path, errno);
    if (count == 0) return;
    consume(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

MachineError MachineError::from_errno(std::string_view action, const fs::path& path, int error) {
  std::ostringstream message;
  message << "cannot " << action << " " << path.string() << ": " << std::strerror(error) << "; " << remedy_for(error);
  return MachineError(message.str());
}

void write_atomically(const fs::path& path, std::string_view bytes) {
  write_atomically(path, {bytes});
}

void write_atomically(const fs::path& path, std::initializer_list<std::string_view> pieces) {
  TemporaryFile temporary = open_temporary(path);
  int error = 0;
  for (const std::string_view piece : pieces)
    if (error == 0) error = temporary.file.write_all(piece);
  if (error == 0 && ::fsync(temporary.file.number()) != 0) error = errno;
  const int close_error = temporary.file.close();
  if (error == 0) error = close_error;
  if (error == 0 && std::rename(temporary.path.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.path.c_str());
    throw MachineError::from_errno("write", path, error);
  }
  sync_folder_of(path);
}

std::string read_file(const fs::path& path) {
  std::string bytes;
  read_in_pieces(path, [&](const char* piece, std::size_t count) { bytes.append(piece, count); });
  return bytes;
}

std::string sha256_of_file(const fs::path& path) {
  Sha256 hash;
  read_in_pieces(path, [&](const char* piece, std::size_t count) { hash.add(piece, count); });
  return hash.hex();
}

std::string sha256(std::string_view bytes) {
  return sha256({bytes});
}

std::string sha256(std::initializer_list<std::string_view> pieces) {
  Sha256 hash;
  for (const std::string_view piece : pieces) hash.add(piece.data(), piece.size());
  return hash.hex();
}

}  // namespace mpm::output
