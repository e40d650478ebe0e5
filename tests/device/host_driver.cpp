// The host driver's table of functions, asked directly for what the CUDA driver API documents.

#include <sys/mman.h>

#include <array>
#include <chrono>
#include <numeric>
#include <thread>

#include "backends/device/drivers/host_library.hpp"
#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Devices for the time of a test, the first of which is current to this thread and has a stream.
class OpenHost {
 public:
  explicit OpenHost(std::vector<device::HostDevice> devices = {{"one", 1 << 20, 0}}) {
    device_setup();  // so that the usual ones are not set later
    device::set_host_devices(std::move(devices));
    open();
  }
  ~OpenHost() {
    close();
    use_usual_devices();
  }
  OpenHost(const OpenHost&) = delete;
  OpenHost& operator=(const OpenHost&) = delete;

  void open() {
    REQUIRE(api.cuDevicePrimaryCtxRetain(&context, 0) == device::driver_success);
    REQUIRE(api.cuCtxSetCurrent(context) == device::driver_success);
    REQUIRE(api.cuStreamCreate(&stream, 0) == device::driver_success);
  }
  void close() { api.cuDevicePrimaryCtxRelease_v2(0); }
  device::DevicePointer allocate(std::size_t bytes) const {
    device::DevicePointer pointer = 0;
    REQUIRE(api.cuMemAlloc_v2(&pointer, bytes) == device::driver_success);
    return pointer;
  }
  std::size_t free_bytes() const {
    std::size_t free = 0, total = 0;
    REQUIRE(api.cuMemGetInfo_v2(&free, &total) == device::driver_success);
    return free;
  }
  /// What a call says that needs a current device and changes nothing.
  device::DriverResult asked() const {
    std::size_t free = 0, total = 0;
    return api.cuMemGetInfo_v2(&free, &total);
  }

  const device::Driver& api = device::host_driver();
  device::ContextHandle context = nullptr;
  device::StreamHandle stream = nullptr;
};

/// A program of one kernel, which writes to its first argument how many teams and lanes there are and its second argument.
std::string noting_program() {
  const std::string text =
      "struct Arguments { unsigned long* to; unsigned long second; };\n"
      "extern \"C\" void mpm_note(const void* at, int teams, int lanes, unsigned) {\n"
      "  const Arguments& a = *static_cast<const Arguments*>(at);\n"
      "  a.to[0] = static_cast<unsigned long>(teams), a.to[1] = static_cast<unsigned long>(lanes), a.to[2] = "
      "a.second;\n"
      "}\n";
  return Programs::shared().of({"a kernel that notes", text, text, {"mpm_note"}, {}});
}

/// A launch of the kernel that notes, each part of which may be changed before.
struct NotingLaunch {
  explicit NotingLaunch(const OpenHost& host) : host(host), stream(host.stream), words(512) {
    const std::string program = noting_program();
    REQUIRE(host.api.cuModuleLoadData(&module, program.data()) == device::driver_success);
    REQUIRE(host.api.cuModuleGetFunction(&function, module, "mpm_note") == device::driver_success);
    words[0] = host.allocate(3 * sizeof(std::uint64_t));
  }
  ~NotingLaunch() { host.api.cuModuleUnload(module); }
  NotingLaunch(const NotingLaunch&) = delete;
  NotingLaunch& operator=(const NotingLaunch&) = delete;

  device::DriverResult operator()() {
    std::array<void*, 5> extra{device::launch_parameter_buffer, block, device::launch_parameter_size, &bytes,
                               device::launch_parameter_end};
    return host.api.cuLaunchKernel(function, grid[0], grid[1], grid[2], lanes[0], lanes[1], lanes[2], 0, stream,
                                   nullptr, has_arguments ? extra.data() : nullptr);
  }
  /// What the launches so far have written.
  std::vector<std::uint64_t> noted() const {
    std::vector<std::uint64_t> found(3);
    CHECK(host.api.cuMemcpyDtoHAsync_v2(found.data(), words[0], 24, stream) == device::driver_success);
    CHECK(host.api.cuStreamSynchronize(stream) == device::driver_success);
    return found;
  }

  const OpenHost& host;
  device::ModuleHandle module = nullptr;
  device::FunctionHandle function = nullptr;
  device::StreamHandle stream;
  std::array<unsigned, 3> grid{3, 1, 1}, lanes{7, 1, 1};
  std::vector<std::uint64_t> words;
  void* block = words.data();
  std::size_t bytes = 16;
  bool has_arguments = true;
};

/// A page of memory at an address, where that is free.
class PageAt {
 public:
  explicit PageAt(std::uintptr_t address)
      // NOLINTNEXTLINE(performance-no-int-to-ptr): the address is what is asked for
      : at_(mmap(reinterpret_cast<void*>(address), bytes, PROT_READ | PROT_WRITE,
                 MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0)) {}
  ~PageAt() {
    if (there()) munmap(at_, bytes);
  }
  PageAt(const PageAt&) = delete;
  PageAt& operator=(const PageAt&) = delete;
  bool there() const { return at_ != MAP_FAILED; }

 private:
  static constexpr std::size_t bytes = 4096;
  void* at_;
};

constexpr device::StreamHandle no_stream = nullptr;

}  // namespace

TEST_CASE("the host driver counts devices from 0, and cuts their names to the room for them", "[device][driver]") {
  const OpenHost host({{"a long name", 1000, 0}, {"another", 2000, 0}});
  int count = 0;
  CHECK(host.api.cuDeviceGetCount(&count) == device::driver_success);
  CHECK(count == 2);
  for (const int number : {-1, 2}) {
    INFO("device " << number);
    device::DeviceNumber device = 0;
    device::ContextHandle context = nullptr;
    std::size_t bytes = 0;
    std::array<char, 16> name{};
    int value = 0;
    for (const device::DriverResult result :
         {host.api.cuDeviceGet(&device, number), host.api.cuDeviceGetName(name.data(), 16, number),
          host.api.cuDeviceTotalMem_v2(&bytes, number), host.api.cuDeviceGetAttribute(&value, 16, number),
          host.api.cuDevicePrimaryCtxRetain(&context, number), host.api.cuDevicePrimaryCtxRelease_v2(number)})
      CHECK(result == device::driver_invalid_device);
  }
  std::size_t bytes = 0;
  CHECK(host.api.cuDeviceTotalMem_v2(&bytes, 1) == device::driver_success);
  CHECK(bytes == 2000);
  for (const auto& [length, expected] : {std::pair{1, ""}, {5, "a lo"}, {12, "a long name"}, {16, "a long name"}}) {
    INFO("room for " << length);
    std::string name(16, 'x');
    CHECK(host.api.cuDeviceGetName(name.data(), length, 0) == device::driver_success);
    std::string whole = std::string(expected) + '\0';  // behind which nothing is written
    whole.resize(16, 'x');
    CHECK(name == whole);
  }
  char none = 'x';
  CHECK(host.api.cuDeviceGetName(&none, 0, 0) == device::driver_invalid_value);
  CHECK(none == 'x');
  const auto attribute = [&](int number) {
    int value = -1;
    CHECK(host.api.cuDeviceGetAttribute(&value, number, 0) == device::driver_success);
    return value;
  };
  CHECK(attribute(device::attribute_most_shared_memory) == 49152);  // 48 KiB without asking for more
  CHECK(attribute(device::attribute_multiprocessors) == 1);
  CHECK(attribute(device::attribute_capability_major) == 0);
  CHECK(attribute(device::attribute_capability_minor) == 0);
}

TEST_CASE("memory of the host driver ends with its device's, and begins at multiples of 256 bytes",
          "[device][driver]") {
  OpenHost host({{"one", 10000, 0}});
  const std::uint64_t left = device::bytes_left_on_host();
  std::size_t free = 0, total = 0;
  device::DevicePointer pointer = 0;
  const device::DevicePointer first = host.allocate(6000);
  CHECK(host.api.cuMemGetInfo_v2(&free, &total) == device::driver_success);
  CHECK(free == 4000);
  CHECK(total == 10000);
  CHECK(host.api.cuMemAlloc_v2(&pointer, 4001) == device::driver_out_of_memory);
  CHECK(host.api.cuMemAlloc_v2(&pointer, 0) == device::driver_invalid_value);
  CHECK(pointer == 0);
  const device::DevicePointer second = host.allocate(4000);
  CHECK(host.free_bytes() == 0);
  CHECK(host.api.cuMemAlloc_v2(&pointer, 1) == device::driver_out_of_memory);
  CHECK(host.api.cuMemFree_v2(second) == device::driver_success);
  CHECK(host.free_bytes() == 4000);
  constexpr device::DevicePointer address_bits = (1ull << 48) - 1;
  for (const device::DevicePointer none : {second, first + 256, first & address_bits, device::DevicePointer{0}})
    CHECK(host.api.cuMemFree_v2(none) == device::driver_invalid_value);
  CHECK(device::bytes_on_host(0) == 6000);
  CHECK(host.api.cuMemFree_v2(first) == device::driver_success);
  for (int k = 0; k < 40; ++k) CHECK(host.allocate(100) % 256 == 0);
  host.close();
  CHECK(device::bytes_left_on_host() == left + 4000);  // which nobody gave back
  host.open();
  CHECK(host.free_bytes() == 10000);
}

TEST_CASE("copies of the host driver are counted, and refused where memory or stream is none", "[device][driver]") {
  const OpenHost host;
  const device::DevicePointer memory = host.allocate(64), none = memory + 1000;
  std::array<char, 64> values{};
  std::iota(values.begin(), values.end(), char{1});
  const std::uint64_t copied = device::bytes_copied_on_host();
  CHECK(host.api.cuMemcpyHtoDAsync_v2(memory, values.data(), 20, host.stream) == device::driver_success);
  CHECK(device::bytes_copied_on_host() == copied + 20);
  CHECK(host.api.cuMemcpyDtoDAsync_v2(memory + 20, memory, 13, host.stream) == device::driver_success);
  std::array<char, 64> found{};
  CHECK(host.api.cuMemcpyDtoHAsync_v2(found.data(), memory + 20, 13, host.stream) == device::driver_success);
  CHECK(device::bytes_copied_on_host() == copied + 33);  // copies within a device are none of the host's
  CHECK(host.api.cuStreamSynchronize(host.stream) == device::driver_success);
  CHECK(std::equal(values.begin(), values.begin() + 13, found.begin()));
  CHECK(found[13] == 0);
  for (const device::DriverResult result : {host.api.cuMemcpyHtoDAsync_v2(none, values.data(), 4, host.stream),
                                            host.api.cuMemcpyDtoHAsync_v2(values.data(), none, 4, host.stream),
                                            host.api.cuMemcpyDtoDAsync_v2(memory, none, 4, host.stream),
                                            host.api.cuMemcpyDtoDAsync_v2(none, memory, 4, host.stream),
                                            host.api.cuMemcpyDtoDAsync_v2(memory, memory + 32, 33, host.stream),
                                            host.api.cuMemsetD8Async(none, 0, 4, host.stream)})
    CHECK(result == device::driver_invalid_value);
  device::GraphHandle graph = nullptr;
  for (const device::DriverResult result :
       {host.api.cuMemcpyHtoDAsync_v2(memory, values.data(), 4, no_stream),
        host.api.cuMemcpyDtoHAsync_v2(values.data(), memory, 4, no_stream),
        host.api.cuMemcpyDtoDAsync_v2(memory, memory, 4, no_stream), host.api.cuMemsetD8Async(memory, 0, 4, no_stream),
        host.api.cuStreamSynchronize(no_stream), host.api.cuStreamBeginCapture_v2(no_stream, device::capture_of_thread),
        host.api.cuStreamEndCapture(no_stream, &graph), host.api.cuStreamDestroy_v2(no_stream)})
    CHECK(result == device::driver_invalid_handle);
}

TEST_CASE("a device of the host driver that was given back is current to no thread", "[device][driver]") {
  OpenHost host({{"one", 1000, 0}, {"another", 1000, 0}});
  device::ContextHandle other = nullptr;
  REQUIRE(host.api.cuDevicePrimaryCtxRetain(&other, 1) == device::driver_success);
  REQUIRE(host.api.cuDevicePrimaryCtxRelease_v2(1) == device::driver_success);
  CHECK(host.asked() == device::driver_success);  // that was the other one
  REQUIRE(host.api.cuDevicePrimaryCtxRetain(&other, 0) == device::driver_success);
  host.close();
  CHECK(host.asked() == device::driver_success);  // it has another user
  host.close();
  CHECK(host.asked() == device::driver_invalid_context);
  REQUIRE(host.api.cuDevicePrimaryCtxRetain(&other, 0) == device::driver_success);
  CHECK(host.asked() == device::driver_invalid_context);  // the next user's is another one
  host.close();
  host.open();
  std::thread([&] { host.close(); }).join();
  CHECK(host.asked() == device::driver_invalid_context);
  host.open();
  CHECK(host.asked() == device::driver_success);
}

TEST_CASE("a result that leaves CUDA in no state to go on is what all later calls return", "[device][driver]") {
  OpenHost host;
  for (const auto& [result, lost] : {std::pair<device::DriverResult, bool>{device::driver_device_unavailable, true},
                                     {device::driver_illegal_address, true},
                                     {702, true},  // CUDA_ERROR_LAUNCH_TIMEOUT
                                     {718, true},  // CUDA_ERROR_INVALID_PC
                                     {device::driver_launch_failed, true},
                                     {device::driver_out_of_memory, false},
                                     {device::driver_not_found, false},
                                     {device::driver_launch_out_of_resources, false},
                                     {720, false},  // CUDA_ERROR_COOPERATIVE_LAUNCH_TOO_LARGE
                                     {device::driver_system_driver_mismatch, false}}) {
    INFO("result " << result);
    device::fail_on_host("cuMemGetInfo_v2", 1, result);
    CHECK(host.asked() == result);
    CHECK(host.asked() == (lost ? result : device::driver_success));
    device::DevicePointer pointer = 0;
    CHECK(host.api.cuMemAlloc_v2(&pointer, 1) == (lost ? result : device::driver_success));
    host.close(), host.open();
    CHECK(host.asked() == device::driver_success);
  }
}

TEST_CASE("a failure is asked for by the name of a function and the number of a call", "[device][driver]") {
  const OpenHost host;
  const auto refused = [](const std::string& function, long call) {
    CHECK_THROWS_WITH(device::fail_on_host(function, call, device::driver_invalid_value),
                      "the driver's table has no " + function);
  };
  refused("cuNothing", 1);
  refused("cuMemGetInfo_v2", 0);
  device::fail_on_host("cuMemGetInfo_v2", 2, device::driver_invalid_value);
  CHECK(host.asked() == device::driver_success);
  CHECK(host.asked() == device::driver_invalid_value);
  CHECK(host.asked() == device::driver_success);
}

TEST_CASE("graphs and events of the host driver are asked for by their handles", "[device][driver]") {
  const OpenHost host;
  const device::DevicePointer memory = host.allocate(4);
  REQUIRE(host.api.cuStreamBeginCapture_v2(host.stream, device::capture_of_thread) == device::driver_success);
  REQUIRE(host.api.cuMemsetD8Async(memory, 0, 4, host.stream) == device::driver_success);
  device::GraphHandle graph = nullptr;
  device::GraphExecHandle made = nullptr;
  REQUIRE(host.api.cuStreamEndCapture(host.stream, &graph) == device::driver_success);
  REQUIRE(host.api.cuGraphInstantiateWithFlags(&made, graph, 0) == device::driver_success);
  REQUIRE(host.api.cuGraphDestroy(graph) == device::driver_success);
  CHECK(host.api.cuGraphLaunch(made, host.stream) == device::driver_success);
  CHECK(host.api.cuGraphLaunch(made, no_stream) == device::driver_invalid_handle);
  CHECK(host.api.cuGraphLaunch(nullptr, host.stream) == device::driver_invalid_handle);
  CHECK(host.api.cuGraphInstantiateWithFlags(&made, nullptr, 0) == device::driver_invalid_handle);

  std::array<device::EventHandle, 3> events{};
  for (device::EventHandle& event : events) REQUIRE(host.api.cuEventCreate(&event, 0) == device::driver_success);
  const auto [first, second, never] = events;
  for (const device::EventHandle event : {first, second}) {
    CHECK(host.api.cuEventRecord(event, host.stream) == device::driver_success);
    CHECK(host.api.cuStreamSynchronize(host.stream) == device::driver_success);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  CHECK(host.api.cuEventRecord(first, no_stream) == device::driver_invalid_handle);
  CHECK(host.api.cuEventRecord(nullptr, host.stream) == device::driver_invalid_handle);
  float milliseconds = 0;
  CHECK(host.api.cuEventElapsedTime(&milliseconds, first, second) == device::driver_success);
  CHECK(milliseconds >= 3);
  CHECK(milliseconds < 3000);
  for (const auto& [start, end] : {std::pair{first, never}, {never, second}, {first, nullptr}, {nullptr, second}})
    CHECK(host.api.cuEventElapsedTime(&milliseconds, start, end) == device::driver_invalid_handle);
  CHECK(host.api.cuEventRecord(first, host.stream) == device::driver_success);  // anew, which has not come yet
  CHECK(host.api.cuEventElapsedTime(&milliseconds, first, second) == device::driver_not_ready);
  CHECK(host.api.cuEventElapsedTime(&milliseconds, second, first) == device::driver_not_ready);
  for (const device::EventHandle event : events) CHECK(host.api.cuEventDestroy_v2(event) == device::driver_success);
  CHECK(host.api.cuGraphExecDestroy(made) == device::driver_success);
}

TEST_CASE("a launch of the host driver has up to 1024 lanes a team, and 4096 bytes of arguments", "[device][driver]") {
  const OpenHost host;
  NotingLaunch launch(host);
  launch.words[1] = 41;
  CHECK(launch() == device::driver_success);
  CHECK(launch.noted() == std::vector<std::uint64_t>{3, 7, 41});
  launch.grid[0] = 1, launch.lanes[0] = 1024, launch.bytes = 4096, launch.words[1] = 42;
  CHECK(launch() == device::driver_success);
  CHECK(launch.noted() == std::vector<std::uint64_t>{1, 1024, 42});
  const auto refused = [&](device::DriverResult result, auto& part, auto value) {
    const auto usual = std::exchange(part, value);
    CHECK(launch() == result);
    part = usual;
  };
  for (unsigned& extent : launch.grid) refused(device::driver_invalid_value, extent, 0u);
  for (unsigned& extent : launch.lanes) refused(device::driver_invalid_value, extent, 0u);
  refused(device::driver_invalid_value, launch.lanes[0], 1025u);
  refused(device::driver_invalid_value, launch.bytes, std::size_t{4097});
  refused(device::driver_invalid_value, launch.block, nullptr);
  refused(device::driver_invalid_value, launch.has_arguments, false);
  refused(device::driver_invalid_handle, launch.function, nullptr);
  refused(device::driver_invalid_handle, launch.stream, nullptr);
  CHECK(launch() == device::driver_success);
}

TEST_CASE("a launch is refused an address of this process, and no number that is none", "[device][driver]") {
  const std::vector<double> values(1000);
  const auto address = reinterpret_cast<std::uintptr_t>(values.data() + 4) / 4096 * 4096 + 4096;
  const PageAt small(0x10001000), above_small(0x140001000);
  OpenHost host({{"one", 1 << 20, 0}});
  const auto result_with = [&](std::uint64_t word) {
    NotingLaunch launch(host);
    launch.words[1] = word;
    const device::DriverResult result = launch();
    if (result == device::driver_success) {
      CHECK(launch.noted()[2] == word);
    } else {
      CHECK(host.asked() == result);  // the device is lost
      host.close(), host.open();
    }
    return result;
  };
  CHECK(result_with(address + 4) == device::driver_illegal_address);
  for (const std::uint64_t odd : {1, 2, 3}) CHECK(result_with(address + odd) == device::driver_success);
  if (!small.there() || !above_small.there()) WARN("an address is taken already: a half of this case is left out");
  if (small.there()) CHECK(result_with(0x10001000) == device::driver_success);  // below 2^32: as good as a count
  if (above_small.there()) CHECK(result_with(0x140001000) == device::driver_illegal_address);
}

TEST_CASE("an image of the host driver is as long as its file, whatever comes behind", "[device][driver]") {
  const std::string program = noting_program();
  CHECK(device::length_of_image(program.data()) == program.size());
  CHECK(device::length_of_image((program + "more").data()) == program.size());
  CHECK(device::length_of_image(nullptr) == 0);
  CHECK(device::length_of_image("no program at all") == 0);
}
