// What kernels take of a GPU by their compiler's word: registers, shared memory, spills, and the ceiling on occupancy.

#include "backends/device/resources.hpp"

#include <atomic>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "backends/device/device_plan.hpp"
#include "backends/device/drivers/nvrtc.hpp"
#include "device/covering.hpp"
#include "device/shipped.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

namespace fs = std::filesystem;

/// Whether NVRTC is there; says by name what is skipped where it is not.
bool has_nvrtc() {
  std::string why;
  if (device::Nvrtc::find(why)) return true;
  WARN("skipped: " << why);
  REQUIRE(why.find("install") != why.npos);
  return false;
}

struct KeptPrograms {
  KeptPrograms() { setenv("MPM_CACHE", folder_of_programs("programs_of_tests").c_str(), 1); }
  ~KeptPrograms() { unsetenv("MPM_CACHE"); }
};

struct Compiled {
  std::string name;
  device::DevicePlan plan;
};

/// Compiles experiments for both architectures, two side by side.
std::vector<Compiled> compile(const std::vector<std::pair<std::string, Experiment>>& experiments) {
  std::vector<Compiled> all(2 * experiments.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t k = next++; k < all.size(); k = next++) {
      const auto& [name, experiment] = experiments[k / 2];
      all[k] = {name, device::device_plan(experiment, make_plan(experiment), device::multiprocessors()[k % 2])};
    }
  };
  std::thread other(work);
  work();
  other.join();
  return all;
}

/// One line a composition: the kernel that takes most of each.
std::string line(const Compiled& compiled) {
  int registers = 0, shared = 0, stack = 0, spilled = 0;
  double least = 1;
  std::string narrowest;
  for (const device::KernelResources& kernel : compiled.plan.taken) {
    registers = larger(registers, kernel.registers), shared = larger(shared, kernel.shared_bytes);
    stack = larger(stack, kernel.stack_bytes), spilled += kernel.spilled_bytes;
    const double share = device::occupancy(kernel, compiled.plan.processor);
    if (share < least) least = share, narrowest = kernel.kernel;
  }
  return compiled.plan.processor.architecture + " " + compiled.name + ": " +
         std::to_string(compiled.plan.taken.size()) + " kernels, at most " + std::to_string(registers) +
         " registers, " + std::to_string(shared) + " B shared, " + std::to_string(stack) + " B stack, " +
         std::to_string(spilled) + " B spilled; occupancy at least " + std::to_string(int(100 * least)) + " % (" +
         narrowest + ")";
}

/// Each kernel has its figures, and none needs more than there is.
void check(const Compiled& compiled) {
  INFO(line(compiled));
  CHECK(compiled.plan.missing.empty());
  REQUIRE(compiled.plan.taken.size() == compiled.plan.kernels.size());
  for (std::size_t k = 0; k < compiled.plan.taken.size(); ++k) {
    const device::KernelResources& kernel = compiled.plan.taken[k];
    INFO(kernel.kernel);
    CHECK(kernel.kernel == compiled.plan.kernels[k]);
    CHECK(kernel.registers > 0);
    CHECK(kernel.shared_bytes <= 48 * 1024);
    CHECK(device::occupancy(kernel, compiled.plan.processor) > 0);
  }
}

}  // namespace

TEST_CASE("what ptxas says of kernels is read, in the words of CUDA 11 and 13", "[device][resources]") {
  const auto read = device::resources_in(
      "ptxas info    : 0 bytes gmem\n"
      "ptxas info    : Compiling entry function 'mpm_scatter' for 'sm_90'\n"
      "ptxas info    : Function properties for mpm_scatter\n"
      "ptxas         .     64 bytes stack frame, 12 bytes spill stores, 20 bytes spill loads\n"
      "ptxas info    : Used 80 registers, used 1 barriers, 64 bytes cumulative stack size, 1024 bytes smem\n"
      "ptxas info    : Compile time = 14.198 ms\n"
      "ptxas info    : Compiling entry function 'mpm_move' for 'sm_80'\n"
      "ptxas info    : Function properties for mpm_move\n"
      "    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads\n"
      "ptxas info    : Used 18 registers, 4224+0 bytes smem, 400 bytes cmem[0]\n");
  REQUIRE(read.size() == 2);
  CHECK(read[0].kernel == "scatter");
  CHECK(read[0].registers == 80);
  CHECK(read[0].shared_bytes == 1024);
  CHECK(read[0].stack_bytes == 64);
  CHECK(read[0].spilled_bytes == 32);
  CHECK(read[1].kernel == "move");
  CHECK(read[1].registers == 18);
  CHECK(read[1].shared_bytes == 4224);
  CHECK(!read[1].spills());
  const std::string begun = "ptxas info    : Compiling entry function 'mpm_move' for 'sm_80'\n";
  for (const std::string& log : {begun, begun + begun, begun + "ptxas info    : Used nothing\n"})
    CHECK_THROWS_WITH(device::resources_in(log), "ptxas says no registers of move");
  // Each line is read from its first letter on.
  const auto bare =
      device::resources_in(begun + "64 bytes stack frame\nUsed 18 registers\n" + begun + "Used 20 registers\n");
  REQUIRE(bare.size() == 2);
  CHECK(bare[0].stack_bytes == 64);
  CHECK(bare[0].registers == 18);
  CHECK(bare[1].kernel == "move");
}

TEST_CASE("the ceiling on occupancy is that of NVIDIA's calculator", "[device][resources]") {
  // Teams of 128 lanes: CUDA C++ Programming Guide, technical specifications of 8.0 and 9.0.
  const device::Multiprocessor &a100 = device::multiprocessor("sm_80"), &h100 = device::multiprocessor("sm_90");
  const auto share = [](const device::Multiprocessor& processor, int registers, int shared, int lanes = 128) {
    device::KernelResources kernel;
    kernel.registers = registers, kernel.shared_bytes = shared;
    return device::occupancy(kernel, processor, lanes);
  };
  CHECK(share(h100, 32, 0) == 1);
  CHECK(share(h100, 33, 0) == 0.75);  // 40 registers are given: 12 teams
  CHECK(share(h100, 64, 0) == 0.5);
  CHECK(share(h100, 128, 0) == 0.25);
  CHECK(share(h100, 255, 0) == 0.125);
  CHECK(share(h100, 32, 48 * 1024) == 0.25);    // 4 teams of 49 KiB in 228
  CHECK(share(a100, 32, 48 * 1024) == 0.1875);  // 3 in 164
  CHECK(share(a100, 16, 0, 32) == 0.5);         // 32 teams of one warp
  CHECK(share(a100, 16, 0, 33) == 1);           // of two
  CHECK(share(h100, 16, 0) == 1);               // 16 teams of four warps
  // A team takes whole units of 128 bytes, and 1 KiB for the system: 45696 + 1024 bytes are more than a fifth of 228 KiB,
  // and 113.25 + 1 KiB more than half.
  CHECK(share(h100, 32, 45632) == 0.25);
  CHECK(share(h100, 32, 115968) == 0.0625);
  CHECK_THROWS_WITH(device::multiprocessor("sm_75"),
                    "no figures are known of the architecture \"sm_75\"; there are sm_80, sm_90");
}

TEST_CASE("no kernel of the standard scenes spills registers", "[device][resources]") {
  if (!has_nvrtc()) return;
  const KeptPrograms programs;
  std::vector<std::pair<std::string, Experiment>> experiments;
  for (const fs::path& file : shipped_experiments())
    if (is_standard(file) || shipped_name(file).starts_with("lessons/melting_block"))  // heat that no wall lets through
      experiments.emplace_back(shipped_name(file), read_shipped(file, "cuda"));
  REQUIRE(experiments.size() == 5);
  for (const Compiled& compiled : compile(experiments)) {
    check(compiled);
    std::cout << line(compiled) << "\n";
    for (const device::KernelResources& kernel : compiled.plan.taken) {
      INFO(compiled.name << ", " << kernel.kernel);
      if (compiled.name.starts_with("benchmarks/")) CHECK(!kernel.spills());
    }
  }
}

TEST_CASE("every shipped experiment and a covering set of pairs compile for sm_80 and sm_90",
          "[device][resources][slow]") {
  if (!has_nvrtc()) return;
  const KeptPrograms programs;
  std::vector<std::pair<std::string, Experiment>> experiments;
  for (const fs::path& file : shipped_experiments())
    experiments.emplace_back(shipped_name(file), read_shipped(file, "cuda"));
  for (const int dimension : {2, 3})
    for (const Mix& mix : every_kernel(dimension))
      for (const std::string precision : {"double", "float"})
        experiments.emplace_back(mix.name(), device_experiment(mix.text(), precision, mix.overrides));
  for (const Compiled& compiled : compile(experiments)) {
    check(compiled);
    std::cout << line(compiled) << "\n";
  }
}
