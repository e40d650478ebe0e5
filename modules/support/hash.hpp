// SHA-256 (FIPS 180-4): what names the inputs of a run and tells a damaged file from a whole one.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace mpm::support {

/// SHA-256 of the file's bytes, 64 lower-case hexadecimal digits. Throws MachineError when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

/// SHA-256 of `bytes`, 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);
/// SHA-256 of the pieces as if they were joined.
std::string sha256(std::initializer_list<std::string_view> pieces);

}  // namespace mpm::support
