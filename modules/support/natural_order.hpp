// Files of a folder in the order a person expects: frame_2 before frame_10.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace mpm::support {

/// Compares texts with each run of digits taken as a number.
bool naturally_less(std::string_view a, std::string_view b);

/// The regular files of `folder` with one of the endings (".png"), hidden ones left out, in natural order. Empty when
/// the folder is missing.
std::vector<std::filesystem::path> files_with_ending(const std::filesystem::path& folder,
                                                     std::initializer_list<std::string_view> endings);

}  // namespace mpm::support
