#include "output/record_file.hpp"

#include <fcntl.h>
#include <sstream>

#include "output/checkpoint_file.hpp"
#include "support/files.hpp"
#include "support/hash.hpp"

namespace mpm::output {

void RecordFile::open() {
  std::error_code error;
  std::filesystem::create_directories(path_.parent_path(), error);
  if (error) throw support::MachineError::from_errno("create the folder", path_.parent_path(), error.value());
  file_ = support::FileDescriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (!file_.valid()) throw support::MachineError::from_errno("append to", path_, errno);
}

void RecordFile::append(std::string_view record) {
  if (!file_.valid()) open();
  int error = ::ftruncate(file_.number(), static_cast<off_t>(bytes_)) != 0 ? errno : 0;
  if (error == 0) error = file_.write_all(record);
  if (error == 0 && ::fsync(file_.number()) != 0) error = errno;
  if (error != 0) {
    // A record that was written in part is cut off now, or by the next append.
    [[maybe_unused]] const int ignored = ::ftruncate(file_.number(), static_cast<off_t>(bytes_));
    throw support::MachineError::from_errno("append to", path_, error);
  }
  index_ += std::to_string(record.size()) + " " + support::sha256(record) + "\n";
  bytes_ += record.size();
  ++count_;
}

std::vector<std::string> RecordFile::resume(const std::string& index) {
  std::vector<std::string> records;
  std::size_t bytes = 0;
  if (!index.empty()) {
    if (!std::filesystem::exists(path_)) throw CheckpointDamaged(path_, "is missing");
    const std::string content = support::read_file(path_);
    std::istringstream lines(index);
    std::string digest;
    for (std::size_t size; lines >> size >> digest; bytes += size) {
      if (size > content.size() - bytes) throw CheckpointDamaged(path_, "is cut short");
      records.push_back(content.substr(bytes, size));
      if (support::sha256(records.back()) != digest)
        throw CheckpointDamaged(path_,
                                "is damaged: record " + std::to_string(records.size()) + " does not match its SHA-256");
    }
  }
  index_ = index;
  bytes_ = bytes;
  count_ = records.size();
  return records;
}

}  // namespace mpm::output
