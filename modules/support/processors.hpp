// How many processors the system gives this process.
#pragma once

#include <filesystem>
#include <string>

namespace mpm::support {

/// Processors that this process can keep busy: those that it may run on (`taskset`), and no more than the share of
/// their time that its control groups allow (a container with a limit), rounded up. At least 1.
int available_processors();

/// Processors whose time a control group and those above it allow, the least of them; infinite where none has a limit.
/// `membership` is the text of /proc/self/cgroup, `root` the folder that control groups are mounted below
/// (/sys/fs/cgroup). Both versions of the interface are read: `cpu.max`, and `cpu.cfs_quota_us` over
/// `cpu.cfs_period_us`. A file that cannot be read limits nothing.
double processors_of_control_groups(const std::string& membership, const std::filesystem::path& root);

}  // namespace mpm::support
