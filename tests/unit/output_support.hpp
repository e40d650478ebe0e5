// A temporary folder and small checks for the tests of modules/output.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

#include "support/temporary_folder.hpp"

namespace mpm::output::testing {

using test::TemporaryFolder;

inline std::size_t entries_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

/// The text of the exception that `action` throws, "" when it throws nothing of this type.
template <typename Error, typename Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace mpm::output::testing
