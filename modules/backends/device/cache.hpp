#pragma once
// Compiled programs are kept in a folder, so that a scene's second start needs no compiler. An entry is staged and
// renamed, so that several processes may write the same one; each carries a hash of its bytes, and one that is damaged
// counts as missing.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace mpm::device {

class ProgramCache {
 public:
  /// The folder is MPM_CACHE, or mpm/programs in XDG_CACHE_HOME or ~/.cache; without any of these, and with an empty
  /// MPM_CACHE, nothing is kept.
  static ProgramCache of_user();
  /// `most_bytes` bounds what it keeps.
  ProgramCache(std::filesystem::path folder, std::uint64_t most_bytes)
      : folder_(std::move(folder)), most_(most_bytes) {}

  const std::filesystem::path& folder() const { return folder_; }
  std::uint64_t most_bytes() const { return most_; }

  /// The program that is kept under a key; nothing where it is not there or damaged.
  std::optional<std::string> find(const std::string& key) const;
  /// Keeps a program, and removes those that were used longest ago as far as the bound asks. A folder that cannot be
  /// written keeps nothing, which is no failure.
  void keep(const std::string& key, const std::string& program) const;

  struct Contents {
    std::size_t programs = 0;
    std::uint64_t bytes = 0;
  };
  Contents contents() const;
  /// Removes all programs; returns what was there. Throws MachineError where one cannot be removed.
  Contents clear() const;

 private:
  std::filesystem::path folder_;  ///< empty: nothing is kept
  std::uint64_t most_;
};

}  // namespace mpm::device
