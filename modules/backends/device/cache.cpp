#include "backends/device/cache.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "support/files.hpp"
#include "support/hash.hpp"

namespace mpm::device {
namespace {

namespace fs = std::filesystem;

constexpr const char* ending = ".program";
constexpr std::size_t hash_length = 64;  // of SHA-256 in hexadecimal, which an entry begins with

struct Entry {
  fs::path path;
  std::uint64_t bytes;
  fs::file_time_type used;
};

std::vector<Entry> entries_of(const fs::path& folder) {
  std::vector<Entry> all;
  std::error_code error;
  for (const fs::directory_entry& file : fs::directory_iterator(folder, error)) {
    if (file.path().extension() != ending) continue;
    std::error_code gone;  // another process may remove it at any time
    const std::uint64_t bytes = file.file_size(gone);
    const fs::file_time_type used = file.last_write_time(gone);
    if (!gone) all.push_back({file.path(), bytes, used});
  }
  return all;
}

}  // namespace

ProgramCache ProgramCache::of_user() {
  constexpr std::uint64_t most = 256ull << 20;
  if (const char* chosen = std::getenv("MPM_CACHE")) return {chosen, most};
  if (const char* caches = std::getenv("XDG_CACHE_HOME"); caches && *caches)
    return {fs::path(caches) / "mpm" / "programs", most};
  if (const char* home = std::getenv("HOME"); home && *home)
    return {fs::path(home) / ".cache" / "mpm" / "programs", most};
  return {{}, most};
}

std::optional<std::string> ProgramCache::find(const std::string& key) const {
  const fs::path path = folder_ / (key + ending);
  std::error_code error;
  if (folder_.empty() || !fs::is_regular_file(path, error)) return std::nullopt;
  try {
    const std::string bytes = support::read_file(path);
    const std::string program = bytes.substr(std::min(hash_length, bytes.size()));
    if (bytes.size() <= hash_length || support::sha256(program) != bytes.substr(0, hash_length)) return std::nullopt;
    fs::last_write_time(path, fs::file_time_type::clock::now(), error);  // the time of its last use
    return program;
  } catch (const support::MachineError&) {
    return std::nullopt;
  }
}

void ProgramCache::keep(const std::string& key, const std::string& program) const {
  if (folder_.empty() || program.size() > most_) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  try {
    support::write_atomically(folder_ / (key + ending), {support::sha256(program), program},
                              support::Durability::of_program);
  } catch (const support::MachineError&) {
    return;  // the program is at hand, and the next start compiles it again
  }
  std::vector<Entry> entries = entries_of(folder_);
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used > b.used; });
  std::uint64_t bytes = 0;
  for (const Entry& entry : entries)
    if ((bytes += entry.bytes) > most_) fs::remove(entry.path, error);
}

ProgramCache::Contents ProgramCache::contents() const {
  Contents all;
  if (folder_.empty()) return all;
  for (const Entry& entry : entries_of(folder_)) ++all.programs, all.bytes += entry.bytes;
  return all;
}

ProgramCache::Contents ProgramCache::clear() const {
  const Contents before = contents();
  if (folder_.empty()) return before;
  for (const Entry& entry : entries_of(folder_)) {
    std::error_code error;
    fs::remove(entry.path, error);
    if (error) throw support::MachineError::from_errno("remove", entry.path, error.value());
  }
  return before;
}

}  // namespace mpm::device
