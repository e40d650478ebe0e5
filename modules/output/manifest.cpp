#include "output/manifest.hpp"

#include <unistd.h>
#include <fstream>
#include <string>
#include <thread>

namespace mpm::output {
namespace {

std::string without_quotes(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\"");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\"\r") - first + 1);
}

/// The value behind the first line of a system file that starts with `key` and has `separator`; empty when there is
/// none.
std::string value_in(const char* file, const std::string& key, char separator) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    const auto position = line.find(separator);
    if (line.starts_with(key) && position != std::string::npos) return without_quotes(line.substr(position + 1));
  }
  return {};
}

std::string compiler() {
#if defined(__clang__)
  return std::string(__VERSION__);
#else
  return std::string("GCC ") + __VERSION__;
#endif
}

std::string instructions() {
  std::string names;
#if defined(__AVX512F__)
  names += " AVX-512";
#elif defined(__AVX2__)
  names += " AVX2";
#elif defined(__SSE2__)
  names += " SSE2";
#elif defined(__ARM_NEON)
  names += " NEON";
#endif
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
  names += " FMA";
#endif
  return names.empty() ? "generic" : names.substr(1);
}

double memory_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page_bytes = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && page_bytes > 0 ? static_cast<double>(pages) * static_cast<double>(page_bytes) : 0.0;
}

}  // namespace

nlohmann::ordered_json machine_description() {
  nlohmann::ordered_json machine;
  const auto add_text = [&](const char* key, const std::string& text) {
    if (!text.empty()) machine[key] = text;
  };
  add_text("cpu", value_in("/proc/cpuinfo", "model name", ':'));
  if (const unsigned cores = std::thread::hardware_concurrency(); cores > 0) machine["cores"] = cores;
  if (const double bytes = memory_bytes(); bytes > 0.0) machine["memory_bytes"] = static_cast<std::uint64_t>(bytes);
  add_text("os", value_in("/etc/os-release", "PRETTY_NAME", '='));
  add_text("compiler", compiler());
  add_text("instructions", instructions());
  add_text("build_type", MPM_BUILD_TYPE);
  return machine;
}

}  // namespace mpm::output
