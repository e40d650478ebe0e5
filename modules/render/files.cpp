#include "render/files.hpp"

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace mpm::render {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  throw std::runtime_error("cannot write '" + path.string() + "': " + std::strerror(error));
}

// Removes the temporary file unless it was renamed.
struct Temporary {
  std::string name;
  int descriptor = -1;
  ~Temporary() {
    if (descriptor >= 0) ::close(descriptor);
    if (!name.empty()) ::unlink(name.c_str());
  }
};

mode_t default_mode() {
  // There is no way to read the mask without setting it; the window is too short to matter for our own files.
  const mode_t mask = ::umask(022);
  ::umask(mask);
  return 0666 & ~mask;
}

}  // namespace

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  Temporary file;
  std::string name = (path.parent_path() / ("." + path.filename().string() + ".XXXXXX.tmp")).string();
  file.descriptor = ::mkstemps(name.data(), 4);  // the ending tells a later run what a killed process left
  if (file.descriptor < 0) fail(path, errno);
  file.name = name;
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  static const mode_t mode = default_mode();
  ::fchmod(file.descriptor, mode);
  const int closed = ::close(file.descriptor);
  file.descriptor = -1;
  if (closed != 0) fail(path, errno);
  if (::rename(file.name.c_str(), path.c_str()) != 0) fail(path, errno);
  file.name.clear();
}

std::filesystem::path with_suffix(const std::filesystem::path& stem, std::string_view extension) {
  std::filesystem::path path = stem;
  path += extension;
  return path;
}

std::string full_precision(double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 17).ptr;
  return {text, end};
}

void CsvTable::row(const std::vector<std::string>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) text_ += ',';
    if (cells[i].find_first_of(",\"\r\n") == std::string::npos) {
      text_ += cells[i];
      continue;
    }
    text_ += '"';
    for (const char c : cells[i]) text_ += c == '"' ? std::string("\"\"") : std::string(1, c);
    text_ += '"';
  }
  text_ += '\n';
}

}  // namespace mpm::render
