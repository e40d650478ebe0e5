#include "support/processors.hpp"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <thread>

namespace mpm::support {
namespace {

namespace fs = std::filesystem;

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Processors that the process may run on; all of the machine's where the system does not say.
int allowed_processors() {
  for (int possible = 1024; possible <= 1 << 20; possible *= 2) {
    cpu_set_t* const set = CPU_ALLOC(static_cast<std::size_t>(possible));
    if (!set) break;
    const std::size_t bytes = CPU_ALLOC_SIZE(static_cast<std::size_t>(possible));
    const int count = ::sched_getaffinity(0, bytes, set) == 0 ? CPU_COUNT_S(bytes, set) : 0;
    CPU_FREE(set);
    if (count > 0) return count;
  }
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The time that a group may use over the period in which it may. No number, or -1 for the time, means no limit.
double quotient(const std::string& time, const std::string& period) {
  char* end = nullptr;
  const double used = std::strtod(time.c_str(), &end), of = std::strtod(period.c_str(), nullptr);
  return end == time.c_str() || !(used > 0) || !(of > 0) ? unlimited : used / of;
}

double processors_of_group(const fs::path& group) {
  std::string time, period;
  std::stringstream(text_of(group / "cpu.max")) >> time >> period;
  return std::min(quotient(time, period),
                  quotient(text_of(group / "cpu.cfs_quota_us"), text_of(group / "cpu.cfs_period_us")));
}

/// Processors that a group below a mount and all groups above it allow. Inside of a container the path may be one of
/// the world outside, which is not there; the mount is then the container's own group.
double processors_below(const fs::path& mount, const std::string& path) {
  double least = processors_of_group(mount);
  fs::path group = mount;
  for (const fs::path& part : fs::path(path).relative_path())
    least = std::min(least, processors_of_group(group /= part));
  return least;
}

}  // namespace

double processors_of_control_groups(const std::string& membership, const fs::path& root) {
  double least = unlimited;
  std::stringstream lines(membership);
  for (std::string line; std::getline(lines, line);) {  // "number:controllers:path"
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), path = line.substr(second + 1);
    if (controllers.empty()) {
      for (const char* mount : {"", "unified"}) least = std::min(least, processors_below(root / mount, path));
    } else if (("," + controllers + ",").find(",cpu,") != std::string::npos) {
      for (const std::string& mount : {controllers, std::string("cpu")})
        least = std::min(least, processors_below(root / mount, path));
    }
  }
  return least;
}

int available_processors() {
  const double limit = processors_of_control_groups(text_of("/proc/self/cgroup"), "/sys/fs/cgroup");
  return std::max(1, static_cast<int>(std::min<double>(allowed_processors(), std::ceil(limit))));
}

}  // namespace mpm::support
