// The launch layer on the host driver: what its memory and its streams are like, and what is said when the driver refuses.

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <regex>

#include "backends/device/device.hpp"
#include "backends/device/field_arrays.hpp"
#include "backends/device/memory.hpp"
#include "backends/device/results.hpp"
#include "backends/device/sorting.hpp"
#include "device/device_support.hpp"
#include "device/scene_size.hpp"
#include "simulation/boundary.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Other devices for the time of a test.
struct OtherDevices {
  explicit OtherDevices(std::vector<device::HostDevice> devices) {
    device_setup();  // so that the usual ones are not set later
    device::set_host_devices(std::move(devices));
  }
  ~OtherDevices() { use_usual_devices(); }
};

/// A failure that does not outlive its test.
struct Injected {
  Injected(const std::string& function, long call, device::DriverResult result) {
    device::fail_on_host(function, call, result);
  }
  ~Injected() { device::forget_failures_on_host(); }
};

std::string usual_scene() {
  Mix mix;
  mix.contact = R"({"type": "coulomb", "friction": 0.2})", mix.close = true;
  return mix.text();
}

/// What a run of the usual scene is stopped by; empty where nothing stops it.
std::string message_of_run(const device::DeviceSetup& setup = device_setup()) {
  const Experiment experiment = device_experiment(usual_scene(), "double");
  try {
    Simulation simulation(experiment, device_factory(setup));
    while (!simulation.finished()) simulation.step();
    simulation.backend().body_state(0);
  } catch (const device::DeviceError& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("memory of the host driver starts as NaN, and its addresses are none of the host's", "[device][driver]") {
  const device::DeviceSetup setup = device_setup();
  device::Device device(*setup.driver, 0);
  const device::DeviceArray<double> array(device, "an array", 100);
  for (const double value : array.download()) CHECK(std::isnan(value));
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGSEGV, SIG_DFL);
    const volatile double value = *const_cast<const volatile double*>(array.data());
    _exit(value == 0 ? 0 : 1);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(!(WIFEXITED(status) && WEXITSTATUS(status) <= 1));
}

TEST_CASE("copies of the host driver wait for a synchronisation and then come in order", "[device][driver]") {
  const device::DeviceSetup setup = device_setup();
  device::Device device(*setup.driver, 0);
  device::DeviceArray<int> array(device, "an array", 3);
  std::vector<int> values{1, 2, 3}, found(3, -1);
  device::StreamHandle stream = nullptr;
  REQUIRE(setup.driver->cuStreamCreate(&stream, 0) == device::driver_success);
  const auto pointer = static_cast<device::DevicePointer>(reinterpret_cast<std::uintptr_t>(array.data()));
  CHECK(setup.driver->cuMemcpyHtoDAsync_v2(pointer, values.data(), 12, stream) == device::driver_success);
  values = {7, 8, 9};  // the source is free at once
  CHECK(setup.driver->cuMemcpyDtoHAsync_v2(found.data(), pointer, 12, stream) == device::driver_success);
  CHECK(setup.driver->cuMemsetD8Async(pointer, 0, 4, stream) == device::driver_success);
  CHECK(found == std::vector<int>{-1, -1, -1});
  CHECK(setup.driver->cuStreamSynchronize(stream) == device::driver_success);
  CHECK(found == std::vector<int>{1, 2, 3});
  CHECK(array.download() == std::vector<int>{0, 2, 3});
  CHECK(setup.driver->cuStreamDestroy_v2(stream) == device::driver_success);
  CHECK_THROWS_WITH(device.read(found.data(), pointer + 4, 12), ContainsSubstring("CUDA_ERROR_INVALID_VALUE"));
}

TEST_CASE("sums of a step have places one behind another, up to the end of the room for them", "[device][driver]") {
  const device::DeviceSetup setup = device_setup();
  device::Device device(*setup.driver, 0);
  device::Results results(device);
  CHECK(results.place(device::Results::room - 3) == 0);
  CHECK(results.place(1) == device::Results::room - 3);
  CHECK(results.has_room_for(2));
  CHECK_FALSE(results.has_room_for(3));
  CHECK(results.look() == device::nothing_stopped);
  CHECK(results.has_room_for(device::Results::room));
  CHECK_FALSE(results.has_room_for(device::Results::room + 1));
}

TEST_CASE("a launch that is handed an address of the host fails, and the device is lost", "[device][driver]") {
  const device::DeviceSetup setup = device_setup();
  const device::Composition composition = device::compose(device_choice_of(device_experiment(usual_scene(), "double")));
  std::vector<double> mass(1000);
  {
    device::Device device(*setup.driver, 0);
    device.load(Programs::shared().of(composition), composition.name);
    device::Arguments<double> arguments{};
    arguments.grid.field[0] = mass.data();
    CHECK_THROWS_WITH(device.launch("clear", arguments, 1, 1),
                      ContainsSubstring("\"clear\"") && ContainsSubstring("CUDA_ERROR_ILLEGAL_ADDRESS"));
    CHECK_THROWS_WITH(device.synchronise(), ContainsSubstring("CUDA_ERROR_ILLEGAL_ADDRESS"));
  }
  device::Device anew(*setup.driver, 0);
  CHECK_NOTHROW(anew.synchronise());
}

TEST_CASE("a run gives its memory back", "[device][driver]") {
  const std::uint64_t left = device::bytes_left_on_host();
  {
    DeviceScene scene(usual_scene(), "double");
    CHECK(device::bytes_on_host(0) >= scene.simulation.backend().particle_bytes());
  }
  CHECK(device::bytes_on_host(0) == 0);
  CHECK(device::bytes_left_on_host() == left);  // and it did so itself, not the end of the context
}

TEST_CASE("a run that does not fit on its device is refused before it begins", "[device][driver]") {
  const OtherDevices small({{"a small one", 50000, false}});
  const long compiled = device::calls_on_host("cuModuleLoadData");
  const std::string message = message_of_run();
  INFO(message);
  CHECK(has(message, "on device a small one, which has 48.8 KiB free"));
  CHECK(has(message, "most is taken by"));
  CHECK(has(message, " of the nodes ("));
  // The three that take most, each with its owner and what it takes.
  const std::string part = R"([\w ]+ of (the nodes|the particles of \w+|the run) \([\d.e+]+ KiB\))";
  CHECK(
      std::regex_search(message, std::regex("most is taken by " + part + ", " + part + ", " + part + ": use larger")));
  CHECK(has(message, "--backend cpu"));
  CHECK(device::calls_on_host("cuModuleLoadData") == compiled);
}

namespace {

/// The bytes that a run has asked a device for after one step, and those that are counted before it begins.
struct Memory {
  double asked = 0, counted = 0;
  double held = 0, of_fields = 0;  ///< by fields, as the backend says and as they are counted
  int blocks = 0;                  ///< of the grid
};

/// 20 small bodies, so that what a body takes of the grid outweighs its particles; with contact they are of three velocity
/// fields in turn.
Memory memory_of_many_bodies(double cell_size, const std::string& contact, const std::string& precision,
                             const std::vector<std::string>& overrides) {
  std::string bodies;
  for (int k = 0; k < 20; ++k) {
    const int column = k % 5, row = k / 5;
    const double x = 0.1 + 0.4 * column, y = 0.1 + 0.5 * row;
    const std::string field = contact.empty() ? "" : R"("field": "f)" + std::to_string(k % 3) + "\", ";
    bodies += (k ? ", " : "") + std::string(R"({"name": "b)") + std::to_string(k) + R"(", "material": "m", )" + field +
              R"("geometry": {"type": "box", "lower": [)" + digits(x) + ", " + digits(y) + R"(], "upper": [)" +
              digits(x + 0.08) + ", " + digits(y + 0.08) + "]}}";
  }
  const Experiment experiment =
      device_experiment(R"({"title": "many", "dimension": 2, "grid": {"cell_size": )" + digits(cell_size) + R"(,
          "domain": [[0, 0], [2, 2]], "boundaries": {"all": "slip"}}, "shape": {"type": "bspline_quadratic"},
          "transfer": {"type": "apic"}, "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000,
          "poisson_ratio": 0.3, "density": 1000}},)" +
                            (contact.empty() ? "" : "\"contact\": " + contact + ",") + "\"bodies\": [" + bodies +
                            R"(], "solver": {"time_step": 0.001, "end_time": 0.1}})",
                        precision, overrides);
  const Plan plan = make_plan(experiment);
  Simulation simulation(experiment, device_factory());
  simulation.step();
  const Backend& backend = simulation.backend();
  const device::SceneSize size = scene_size(experiment, backend);
  Memory memory{static_cast<double>(device::bytes_on_host(0)), 0,
                static_cast<double>(backend.particle_bytes() + backend.grid_bytes()), 0, size.blocks};
  const std::set<std::string> beside{
      "blocks", "contact", "exact sums", "nodes that meet", "rows of particles", "tables of blocks", "sums"};
  for (const device::TakenMemory& taken : device::taken_memory(experiment, plan, size)) {
    memory.counted += taken.bytes;
    if (!beside.count(taken.field)) memory.of_fields += taken.bytes;
  }
  return memory;
}

}  // namespace

TEST_CASE("what a device is asked for is counted before a run begins, in a scene of many bodies", "[device][driver]") {
  const std::string by_nodes = R"({"type": "coulomb", "friction": 0.2})",
                    by_particles = R"({"type": "coulomb", "friction": 0.2, "normal": "widest_gap"})";
  for (const auto& [contact, precision, sums] : {std::tuple{std::string(), "double", "fast"},
                                                 {by_nodes, "float", "fast"},
                                                 {by_particles, "double", "fast"},
                                                 {std::string(), "float", "deterministic"}}) {
    INFO(contact << ", " << precision << ", " << sums << " sums");
    const std::vector<std::string> overrides(sums == std::string("fast") ? 0 : 1, deterministic_sums);
    const Memory coarse = memory_of_many_bodies(0.04, contact, precision, overrides),
                 fine = memory_of_many_bodies(0.01, contact, precision, overrides);
    // What is not counted is the same on any grid: parameters, and with contact the edges of bodies.
    CHECK(fine.asked - coarse.asked == fine.counted - coarse.counted);
    CHECK(coarse.asked >= coarse.counted);
    CHECK(coarse.asked - coarse.counted < 15000 * (contact.empty() ? 1 : 3));
    CHECK(fine.blocks > 2 * device::chunk_of_blocks);  // so that chunks of the table count too
    CHECK(fine.held == fine.of_fields);
  }
}

TEST_CASE("partial sums have room for every team of the largest body and of the nodes", "[device][driver]") {
  for (const int lanes : {1, 7, 32})
    for (const auto& [particles, nodes] : {std::pair{std::vector<std::size_t>{1000, 37}, 64}, {{5, 6}, 640}}) {
      const int most = std::max(static_cast<int>(particles[0]), nodes), teams = (most + lanes - 1) / lanes;
      const std::size_t room = device::room_for_sums({particles, static_cast<std::size_t>(nodes), 9, lanes});
      CHECK(room >= static_cast<std::size_t>(device::most_sums * teams));
      CHECK(room <= static_cast<std::size_t>(device::most_sums * (teams + 1)));
    }
}

TEST_CASE("sizes are said in the largest unit that leaves a number above one", "[device][driver]") {
  for (const auto& [bytes, words] : {std::pair{0.0, "0 bytes"},
                                     {1023.0, "1023 bytes"},
                                     {1536.0, "1.5 KiB"},
                                     {48.8 * 1024, "48.8 KiB"},
                                     {0x1p20, "1 MiB"},
                                     {0x1.8p31, "3 GiB"},
                                     {0x1p42, "4 TiB"},
                                     {0x1p54, "1.64e+04 TiB"}})
    CHECK(device::bytes_in_words(bytes) == words);
}

TEST_CASE("a device that cannot be opened is said with its number", "[device][driver]") {
  const OtherDevices two({{"one", 0, false}, {"another", 0, false}});
  const Injected failure("cuDeviceGet", 2, device::driver_invalid_device);
  CHECK_THROWS_WITH(device::devices_of(device::host_driver()),
                    ContainsSubstring("the driver failed to open device 1: CUDA_ERROR_INVALID_DEVICE, invalid device "
                                      "ordinal; see mpm list --devices"));
  const Injected other("cuDeviceGet", 1, device::driver_invalid_device);
  CHECK_THROWS_WITH(device::Device(device::host_driver(), 1),
                    ContainsSubstring("the driver failed to open device 1: CUDA_ERROR_INVALID_DEVICE, "));
}

TEST_CASE("a result that the driver has no words for is said by its number", "[device][driver]") {
  const Injected failure("cuDeviceGetCount", 1, 12345);
  CHECK_THROWS_WITH(device::devices_of(device::host_driver()),
                    ContainsSubstring("the driver failed to count devices: error 12345; what was written is kept"));
}

TEST_CASE("memory that runs out all the same is said with what is asked and free", "[device][driver]") {
  const DeviceScene compiled(usual_scene(), "double");  // compiles
  const Injected failure("cuMemAlloc_v2", 20, device::driver_out_of_memory);
  const std::string message = message_of_run();
  INFO(message);
  CHECK(has(message, "device 0 (host) failed to give "));
  CHECK(has(message, " free: CUDA_ERROR_OUT_OF_MEMORY"));
  CHECK(has(message, "--set /precision=float"));
}

TEST_CASE("whatever memory is asked for, what for is said", "[device][driver]") {
  std::map<std::string, int> asked;  // by what for
  for (long call = 1;; ++call) {
    const Injected failure("cuMemAlloc_v2", call, device::driver_out_of_memory);
    const std::string message = message_of_run();
    if (message.empty()) break;
    std::smatch found;
    INFO(message);
    REQUIRE(std::regex_search(message, found, std::regex("failed to give [\\d.]+ (bytes|KiB) to (.+), with ")));
    ++asked[found[2]];
  }
  for (const std::string body : {"a", "b"}) {
    CHECK(asked["the particles of " + body] == 1);
    CHECK(asked["the blocks of " + body] ==
          5);  // of each particle, of the table, its chunks, those in use, their number
  }
  CHECK(asked["the nodes"] >= 2);
  CHECK(asked.count("the blocks of ") == 0);
}

TEST_CASE("whichever function of the driver fails, a run stops with its name and gives its memory back",
          "[device][driver]") {
  const long before = device::calls_on_host("cuLaunchKernel");
  CHECK(message_of_run().empty());
  const std::uint64_t left = device::bytes_left_on_host();
  const long launches = device::calls_on_host("cuLaunchKernel") - before;
  const std::vector<std::string> functions{"cuDeviceGetCount",     "cuDeviceGet",
                                           "cuDeviceGetName",      "cuDeviceGetAttribute",
                                           "cuDriverGetVersion",   "cuCtxSetCurrent",
                                           "cuMemGetInfo_v2",      "cuMemAlloc_v2",
                                           "cuMemcpyHtoDAsync_v2", "cuMemcpyDtoHAsync_v2",
                                           "cuMemsetD8Async",      "cuDevicePrimaryCtxRetain",
                                           "cuStreamCreate",       "cuStreamSynchronize",
                                           "cuModuleLoadData",     "cuModuleGetFunction",
                                           "cuLaunchKernel",       "cuStreamBeginCapture_v2",
                                           "cuStreamEndCapture",   "cuGraphInstantiateWithFlags",
                                           "cuGraphLaunch"};
  for (const std::string& function : functions)
    for (const device::DriverResult result : {device::driver_launch_failed, device::driver_not_initialized}) {
      INFO(function << " " << result);
      const Injected failure(function, 1, result);
      const std::string message = message_of_run();
      INFO(message);
      CHECK(has(message,
                result == device::driver_launch_failed ? "CUDA_ERROR_LAUNCH_FAILED" : "CUDA_ERROR_NOT_INITIALIZED"));
      CHECK(device::bytes_on_host(0) == 0);
      CHECK(device::bytes_left_on_host() == left);
    }
  for (const long call : {launches / 10, launches - 1}) {
    INFO("call " << call);
    const Injected failure("cuLaunchKernel", call, device::driver_launch_out_of_resources);
    CHECK(has(message_of_run(), "failed to launch the phase \""));
    CHECK(device::bytes_on_host(0) == 0);
  }
  CHECK(message_of_run().empty());
}

TEST_CASE("a driver that is too old for the program is said with its version", "[device][driver]") {
  const Injected failure("cuModuleLoadData", 1, device::driver_no_binary_for_device);
  const std::string message = message_of_run();
  INFO(message);
  CHECK(has(message, "the driver is of CUDA 12.0"));
  CHECK(has(message, "CUDA_ERROR_NO_BINARY_FOR_GPU"));
  CHECK(has(message, "install a newer driver"));
}

TEST_CASE("a driver's version is that of its CUDA", "[device][driver]") {
  device::Driver driver = device::host_driver();
  driver.cuDriverGetVersion = [](int* version) -> device::DriverResult {
    *version = 12080;
    return device::driver_success;
  };
  device::Device device(driver, 0);
  const Injected failure("cuModuleLoadData", 1, device::driver_no_binary_for_device);
  CHECK_THROWS_WITH(
      device.load("no program", "of a test"),
      "device 0 (host) failed to load the program \"of a test\" (the driver is of CUDA 12.8): "
      "CUDA_ERROR_NO_BINARY_FOR_GPU, no kernel image is available for the device; the driver is older than "
      "the compiler that made this program: install a newer driver or an older NVRTC (CUDA_PATH), or use "
      "--backend cpu");
}

TEST_CASE("a refusal of the driver says what was asked of which device", "[device][driver]") {
  const OtherDevices small({{"first", 0, false}, {"a small one", 1000, false}});
  const std::string kept =
      "; what was written is kept, and a run with a checkpoint goes on with --resume, also with --device host";
  device::Device device(device::host_driver(), 1);
  CHECK_THROWS_WITH(device.allocate(1536, "an array"),
                    "device 1 (a small one) failed to give 1.5 KiB to an array, with 1000 bytes free: "
                    "CUDA_ERROR_OUT_OF_MEMORY, out of memory; use larger cells, fewer particles a cell, --set "
                    "/precision=float, a device with more memory, or --backend cpu");
  const std::string refused = ": CUDA_ERROR_NOT_INITIALIZED, initialization error" + kept;
  const auto said = [&](const std::string& function, const auto& call) {
    const Injected failure(function, 1, device::driver_not_initialized);
    try {
      call();
    } catch (const device::DeviceError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(said("cuMemAlloc_v2", [&] { device.allocate(8, "an array"); }) ==
        "device 1 (a small one) failed to give memory to an array" + refused);
  CHECK(said("cuStreamSynchronize", [&] { device.synchronise(); }) ==
        "device 1 (a small one) failed to copy" + refused);
  const device::Composition composition = device::compose(device_choice_of(device_experiment(usual_scene(), "double")));
  device.load(Programs::shared().of(composition), composition.name);
  device::DeviceArray<device::Stopped> stop(device, "a test", 1);
  stop.upload({device::nothing_stopped});
  device::Arguments<double> nothing{};
  nothing.stop = stop.data();
  CHECK(said("cuModuleGetFunction", [&] { device.launch("clear", nothing, 1, 1); }) ==
        "device 1 (a small one) failed to find the phase \"clear\"" + refused);
  device.launch("clear", nothing, 1, 1);
  CHECK(said("cuStreamSynchronize", [&] { device.synchronise(); }) ==
        "device 1 (a small one) failed in the work up to the phase \"clear\"" + refused);
  CHECK(said("cuLaunchKernel", [&] { device.launch("clear", nothing, 1, 1); }) ==
        "device 1 (a small one) failed to launch the phase \"clear\"" + refused);
}

TEST_CASE("a capture that is abandoned leaves no graph", "[device][driver]") {
  device::Device device(device::host_driver(), 0);
  const long destroyed = device::calls_on_host("cuGraphDestroy");
  device.begin_capture();
  device.abandon_capture();
  CHECK(device::calls_on_host("cuGraphDestroy") == destroyed + 1);
  device.abandon_capture();  // there is none
  CHECK(device::calls_on_host("cuGraphDestroy") == destroyed + 1);
}

TEST_CASE("phases take the milliseconds that events of the device are apart, a launch after the other",
          "[device][driver]") {
  device::Driver driver = device::host_driver();
  driver.cuEventElapsedTime = [](float* milliseconds, device::EventHandle,
                                 device::EventHandle) -> device::DriverResult {
    *milliseconds = 2.5f;
    return device::driver_success;
  };
  device::DeviceSetup setup = device_setup();
  setup.driver = &driver;
  const Experiment experiment = device_experiment(usual_scene(), "double");
  Simulation simulation(experiment, device_factory(setup));
  simulation.backend().measure_phases(true);
  const long before = device::calls_on_host("cuLaunchKernel");
  simulation.step();
  simulation.backend().body_state(0);  // waits for the step's end
  double sum = 0;
  for (const auto& [phase, seconds] : simulation.backend().phase_seconds()) sum += seconds;
  CHECK(sum == Approx(0.0025 * static_cast<double>(device::calls_on_host("cuLaunchKernel") - before)));
}

TEST_CASE("a program that is none is refused", "[device][driver]") {
  device::DeviceSetup setup = device_setup();
  setup.compile = [](const device::Composition&, const std::string&) { return std::string("no program at all"); };
  CHECK(has(message_of_run(setup), "CUDA_ERROR_INVALID_IMAGE"));
  device::Device device(*setup.driver, 0);
  CHECK_NOTHROW(device.synchronise());
  device::ModuleHandle module = nullptr;
  CHECK(setup.driver->cuModuleLoadData(&module, nullptr) == device::driver_invalid_image);
}

TEST_CASE("devices are counted from 0, and one that is not there is refused", "[device][driver]") {
  const std::string see_devices = "; see mpm list --devices for the devices of this machine, or use --backend cpu";
  device::DeviceSetup setup = device_setup();
  {
    const OtherDevices two({{"one", 0, false}, {"another", 0, false}});
    setup.number = 1;
    const Experiment experiment = device_experiment(usual_scene(), "double");
    const Simulation simulation(experiment, device_factory(setup));
    CHECK(device::bytes_on_host(0) == 0);
    CHECK(device::bytes_on_host(1) > 0);
    setup.number = 2;
    CHECK(message_of_run(setup) == "there is no device 2: the driver lists 2 devices, from number 0" + see_devices);
    const auto all = device::devices_of(device::host_driver());
    REQUIRE(all.size() == 2);
    CHECK(all[1].name == "another");
    CHECK(all[1].bytes > 0);
  }
  const OtherDevices none({});
  setup.number = 0;
  const std::string message = message_of_run(setup);
  CHECK(message == "the driver lists no device" + see_devices);
}

namespace {

/// Stands in for launches of the host's driver, and keeps which phases are launched and how many teams the largest scatter
/// has had.
struct LookedAt {
  inline static std::set<std::string> phases;
  inline static device::FunctionHandle scatter = nullptr;
  inline static unsigned teams = 0;
  static device::DriverResult find(device::FunctionHandle* found, device::ModuleHandle module, const char* name) {
    const device::DriverResult result = device::host_driver().cuModuleGetFunction(found, module, name);
    phases.insert(name);
    if (name == std::string("mpm_scatter")) scatter = *found;
    return result;
  }
  static device::DriverResult launch(device::FunctionHandle function, unsigned x, unsigned y, unsigned z,
                                     unsigned lanes, unsigned lanes_y, unsigned lanes_z, unsigned shared,
                                     device::StreamHandle stream, void** parameters, void** extra) {
    if (function == scatter) teams = larger(teams, x);
    return device::host_driver().cuLaunchKernel(function, x, y, z, lanes, lanes_y, lanes_z, shared, stream, parameters,
                                                extra);
  }
  static device::DriverResult attribute(int* value, int asked, device::DeviceNumber device) {
    const device::DriverResult result = device::host_driver().cuDeviceGetAttribute(value, asked, device);
    if (asked == device::attribute_multiprocessors) *value = 2;
    return result;
  }
};

}  // namespace

TEST_CASE("as many teams work on the blocks of a body as the device's multiprocessors hold", "[device][driver]") {
  device::Driver driver = device::host_driver();
  driver.cuModuleGetFunction = LookedAt::find, driver.cuLaunchKernel = LookedAt::launch;
  driver.cuDeviceGetAttribute = LookedAt::attribute;
  device::DeviceSetup setup = device_setup();
  setup.driver = &driver;
  // 52 by 40 cells have more than 100 blocks of 4 by 4, and the bodies as many particles.
  const Experiment experiment =
      device_experiment(Mix{}.text(), "double", {"/grid/cell_size=0.025", "/solver/time_step=0.001"});
  Simulation simulation(experiment, device_factory(setup));
  simulation.step();
  CHECK(LookedAt::teams == 2 * 32);  // CUDA C++ Programming Guide: at most 32 a multiprocessor, of 8.0 and 9.0
  setup.lanes = 257;
  CHECK_THROWS_WITH(Simulation(experiment, device_factory(setup)), "a team has 1 to 256 lanes");
}

TEST_CASE("forces are folded where nodes have them apart from the momenta", "[device][driver]") {
  device::Driver driver = device::host_driver();
  driver.cuModuleGetFunction = LookedAt::find;
  device::DeviceSetup setup = device_setup();
  setup.driver = &driver;
  for (const bool apart : {false, true}) {
    LookedAt::phases.clear();
    const Experiment experiment = device_experiment(
        Mix{}.text(), "double", {set("/output", apart ? R"({"ledger": true})" : R"({"ledger": false})")});
    Simulation simulation(experiment, device_factory(setup));
    simulation.step();
    CHECK(LookedAt::phases.count("mpm_fold_masses") == 1);
    CHECK(LookedAt::phases.count("mpm_fold_forces") == (apart ? 1 : 0));
  }
}

TEST_CASE("a step that ends with no pass is refused", "[device][driver]") {
  const Experiment experiment = device_experiment(Mix{}.text(), "double");
  Step loop;
  loop.kind = Step::Kind::repeat_until, loop.children.emplace_back().kind = Step::Kind::pass;
  for (const Step& last : {loop, Step{}})
    CHECK_THROWS_WITH(Simulation(experiment,
                                 [&](const Experiment& e, Plan plan, const std::vector<SeededBody>& bodies) {
                                   plan.step.children.push_back(last);
                                   return device::make_device_backend(e, plan, bodies, device_setup());
                                 }),
                      "the device cannot tell which pass ends a step");
}

TEST_CASE("more fields than the tables of a device hold are refused", "[device][driver]") {
  device::Device device(device::host_driver(), 0);
  CHECK_THROWS_WITH(device::FieldArrays<double>(device, "an owner", std::vector<Field>(65), 1),
                    "a scene has 65 fields and the device's tables hold 64");
}

TEST_CASE("phases are timed by events of the device", "[device][driver]") {
  DeviceScene scene(usual_scene(), "double");
  Backend& backend = scene.simulation.backend();
  CHECK(backend.phase_seconds().empty());
  backend.measure_phases(true);
  scene.simulation.step();
  scene.body(0);  // waits for the step's end
  const auto seconds = backend.phase_seconds();
  for (const std::string phase : {"scatter", "gather", "move", "contact", "stress_0"}) {
    REQUIRE(seconds.count(phase) == 1);
    CHECK(seconds.at(phase) > 0);
  }
  backend.measure_phases(false);
  scene.simulation.step();
  CHECK(backend.phase_seconds() == seconds);
}
