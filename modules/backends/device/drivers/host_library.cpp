#include "backends/device/drivers/host_library.hpp"

#include <dlfcn.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "support/files.hpp"

namespace mpm::device {

std::size_t length_of_image(const void* image) {
  const auto* const bytes = static_cast<const unsigned char*>(image);
  if (!image || std::memcmp(bytes, "\177ELF\2", 5) != 0) return 0;
  std::uint64_t table = 0;
  std::uint16_t entry = 0, count = 0;
  std::memcpy(&table, bytes + 0x28, 8), std::memcpy(&entry, bytes + 0x3a, 2), std::memcpy(&count, bytes + 0x3c, 2);
  return table + static_cast<std::size_t>(entry) * count;
}

void* load_library(std::string_view bytes) {
  std::string folder = (std::filesystem::temp_directory_path() / "mpm_device_XXXXXX").string();
  if (!mkdtemp(folder.data())) return nullptr;
  void* library = nullptr;
  try {
    const std::filesystem::path file = std::filesystem::path(folder) / "module.so";
    support::write_atomically(file, bytes, support::Durability::of_program);
    library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  } catch (const std::exception&) {  // there is no file to load
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return library;
}

}  // namespace mpm::device
