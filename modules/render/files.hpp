// Files that are either whole or absent, and comma-separated tables.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mpm::render {

/// Writes under a temporary name in the same folder, then renames.
/// @throws std::runtime_error naming the path and the cause (no permission, disk full, no such folder).
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// stem + extension; unlike replace_extension it keeps a dot that belongs to the stem ("run_0.5").
std::filesystem::path with_suffix(const std::filesystem::path& stem, std::string_view extension);

/// Seventeen significant digits, enough to read the same double back; never depends on the locale.
std::string full_precision(double value);

/// RFC 4180 text: cells with commas, quotes or line ends are quoted.
class CsvTable {
 public:
  void row(const std::vector<std::string>& cells);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace mpm::render
