#pragma once
// Files that an experiment names beside itself.

#include <filesystem>
#include <string>

namespace mpm {

struct InputFile {
  std::string pointer;         ///< JSON pointer of what names it
  std::filesystem::path path;  ///< absolute
  std::string sha256;
};

}  // namespace mpm
