#include "backends/device/resources.hpp"

#include <algorithm>
#include <regex>
#include <stdexcept>

namespace mpm::device {
namespace {

/// The number that a pattern's first group takes from a line; 0 where it does not match.
int number_in(const std::string& line, const char* pattern) {
  std::smatch found;
  return std::regex_search(line, found, std::regex(pattern)) ? std::stoi(found[1]) : 0;
}

int rounded_up(int value, int unit) {
  return (value + unit - 1) / unit * unit;
}

}  // namespace

std::vector<KernelResources> resources_in(std::string_view log) {
  std::vector<KernelResources> all;
  std::string name;
  KernelResources found;
  for (std::size_t at = 0; at < log.size();) {
    const std::size_t end = std::min(log.find('\n', at), log.size());
    const std::string line(log.substr(at, end - at));
    at = end + 1;
    std::smatch entry;
    if (std::regex_search(line, entry, std::regex("Compiling entry function '(?:mpm_)?([^']*)'"))) {
      if (!name.empty()) throw std::invalid_argument("ptxas says no registers of " + name);
      found = {}, name = found.kernel = entry[1];
    }
    if (name.empty()) continue;
    if (line.find("bytes stack frame") != std::string::npos) {
      found.stack_bytes = number_in(line, "(\\d+) bytes stack frame");
      found.spilled_bytes = number_in(line, "(\\d+) bytes spill stores") + number_in(line, "(\\d+) bytes spill loads");
    }
    if (line.find("Used ") != std::string::npos) {
      found.registers = number_in(line, "Used (\\d+) registers");
      found.shared_bytes = number_in(line, "(\\d+)(?:\\+\\d+)? bytes smem");
      if (found.registers == 0) throw std::invalid_argument("ptxas says no registers of " + name);
      all.push_back(found);
      name.clear();
    }
  }
  if (!name.empty()) throw std::invalid_argument("ptxas says no registers of " + name);
  return all;
}

const std::vector<Multiprocessor>& multiprocessors() {
  static const std::vector<Multiprocessor> all{{"sm_80", 64, 32, 65536, 164 * 1024},
                                               {"sm_90", 64, 32, 65536, 228 * 1024}};
  return all;
}

double occupancy(const KernelResources& kernel, const Multiprocessor& processor, int lanes) {
  constexpr int warp = 32, register_unit = 256, shared_of_system = 1024, shared_unit = 128;
  const int warps = rounded_up(lanes, warp) / warp;
  const int of_warp = rounded_up(kernel.registers * warp, register_unit);
  const int by_registers = processor.registers / of_warp / warps;
  const int by_shared = processor.shared_bytes / (rounded_up(kernel.shared_bytes, shared_unit) + shared_of_system);
  const int blocks = std::min({processor.blocks, processor.warps / warps, by_registers, by_shared});
  return static_cast<double>(blocks * warps) / processor.warps;
}

}  // namespace mpm::device
