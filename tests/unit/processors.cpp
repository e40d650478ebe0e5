// How many processors a process may use: those it may run on, limits of its control groups, and a study's shares of
// them.
#include "support/processors.hpp"

#include <sched.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "study/run_study.hpp"
#include "support/catch.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::support;
using namespace mpm::test;

namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// Restores, at its end, the processors that this thread may run on.
class Affinity {
 public:
  Affinity() { ::sched_getaffinity(0, sizeof before_, &before_); }
  ~Affinity() { ::sched_setaffinity(0, sizeof before_, &before_); }
  int count() const { return CPU_COUNT(&before_); }
  void keep_one() const {
    int processor = 0;
    while (!CPU_ISSET(processor, &before_)) ++processor;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    ::sched_setaffinity(0, sizeof one, &one);
  }

 private:
  cpu_set_t before_{};
};

}  // namespace

TEST_CASE("processors are those that the process may run on") {
  const Affinity affinity;
  CHECK(available_processors() >= 1);
  CHECK(available_processors() <= affinity.count());
  affinity.keep_one();
  CHECK(available_processors() == 1);
}

TEST_CASE("control groups of version 2: the least limit of a group and those above it") {
  const TemporaryFolder root;
  const std::string membership = "0::/user/job\n";
  CHECK(std::isinf(processors_of_control_groups(membership, root.path())));
  write(root / "user/job/cpu.max", "max 100000\n");
  CHECK(std::isinf(processors_of_control_groups(membership, root.path())));
  write(root / "user/cpu.max", "250000 100000\n");
  CHECK(processors_of_control_groups(membership, root.path()) == 2.5);
  write(root / "user/job/cpu.max", "50000 100000\n");
  CHECK(processors_of_control_groups(membership, root.path()) == 0.5);
  // Inside of a container the path of the world outside is not there, and the mount is the container's group.
  write(root / "cpu.max", "150000 50000\n");
  CHECK(processors_of_control_groups("0::/docker/0123\n", root.path()) == 3);
}

TEST_CASE("control groups of version 1: quota over period of the controller cpu") {
  const TemporaryFolder root;
  const std::string membership = "5:memory:/m\n4:cpu,cpuacct:/job\n0::/\n";
  write(root / "cpu,cpuacct/job/cpu.cfs_quota_us", "-1\n");
  write(root / "cpu,cpuacct/job/cpu.cfs_period_us", "100000\n");
  CHECK(std::isinf(processors_of_control_groups(membership, root.path())));
  write(root / "cpu,cpuacct/job/cpu.cfs_quota_us", "400000\n");
  CHECK(processors_of_control_groups(membership, root.path()) == 4);
  write(root / "memory/m/cpu.cfs_quota_us", "1000\n");  // limit of another controller, which says nothing
  write(root / "memory/m/cpu.cfs_period_us", "100000\n");
  CHECK(processors_of_control_groups(membership, root.path()) == 4);
}

TEST_CASE("what cannot be read of control groups limits nothing") {
  const TemporaryFolder root;
  for (const char* text : {"", "max", "\n", "100000", "x y", "100000 0", "0 100000", "-5 100000"}) {
    INFO(text);
    write(root / "cpu.max", text);
    CHECK(std::isinf(processors_of_control_groups("0::/\n", root.path())));
  }
  for (const char* membership : {"", "\n", "0:", "::", "garbage"})
    CHECK(std::isinf(processors_of_control_groups(membership, root / "nowhere")));
}

TEST_CASE("a study asks for no more threads than there are processors") {
  const auto share = [](int processors, int jobs, int threads) {
    const study::Shares shares = study::share_processors(processors, jobs, threads);
    return std::pair(shares.jobs, shares.threads);
  };
  CHECK(share(2, 0, 1) == std::pair(2, 1));
  CHECK(share(2, 0, 2) == std::pair(1, 2));
  CHECK(share(2, 0, 64) == std::pair(1, 2));
  CHECK(share(8, 0, 3) == std::pair(2, 3));
  CHECK(share(1, 0, 1) == std::pair(1, 1));
  CHECK(share(2, 2, 2) == std::pair(2, 1));
  CHECK(share(8, 2, 64) == std::pair(2, 4));
  CHECK(share(2, 5, 3) == std::pair(5, 1));  // runs at a time are as many as were asked for
  CHECK(share(8, 1, 2) == std::pair(1, 2));
}
