// Records appended to one file, each vouched for by its SHA-256: what a run holds in memory until its end, kept for the
// case that it does not come to its end.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "support/file_descriptor.hpp"

namespace mpm::output {

class RecordFile {
 public:
  /// Names the file, and touches nothing until the first append or resume.
  explicit RecordFile(std::filesystem::path path) : path_(std::move(path)) {}

  /// Appends a record, which is on the disk when this returns. Throws MachineError; the file then ends with its last
  /// whole record.
  void append(std::string_view record);

  std::size_t count() const { return count_; }

  /// The index, a line "bytes sha256" for each record: what `resume` needs to find the same records again.
  const std::string& index() const { return index_; }

  /// The records that an index lists; later ones are cut off at the next append. Throws CheckpointDamaged when the file
  /// does not hold them as they were written.
  std::vector<std::string> resume(const std::string& index);

 private:
  void open();

  std::filesystem::path path_;
  support::FileDescriptor file_;
  std::string index_;
  std::size_t bytes_ = 0, count_ = 0;
};

}  // namespace mpm::output
