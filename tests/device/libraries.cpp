// NVIDIA's driver and compiler, which are looked for when they are wanted: libraries of a few lines stand in for them, in a
// process of its own, as what is found stays loaded.

#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "backends/device/cache.hpp"
#include "backends/device/device_plan.hpp"
#include "backends/device/drivers/cuda.hpp"
#include "backends/device/drivers/nvrtc.hpp"
#include "backends/device/program.hpp"
#include "device/device_support.hpp"
#include "support/files.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;
namespace fs = std::filesystem;

namespace {

/// Makes a library of this text whose own name is that of the file.
fs::path library_of(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  const fs::path source = file.parent_path() / "source.cpp";
  support::write_atomically(source, text, support::Durability::of_program);
  const std::string command = "c++ -shared -fPIC -w -Wl,-soname," + file.filename().string() + " -o '" + file.string() +
                              "' '" + source.string() + "'";
  REQUIRE(std::system(command.c_str()) == 0);
  return file;
}

/// What a function returns in a process of its own, in which these libraries are there before it looks for any.
std::string in_process_with(const std::vector<fs::path>& libraries, const std::function<std::string()>& function) {
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    std::string said;
    try {
      for (const fs::path& library : libraries)
        if (!dlopen(library.c_str(), RTLD_NOW | RTLD_GLOBAL)) throw std::runtime_error(dlerror());
      said = function();
    } catch (const std::exception& error) {
      said = std::string("threw ") + error.what();
    }
    const bool written = write(ends[1], said.data(), said.size()) == static_cast<ssize_t>(said.size());
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  std::string said;
  char part[4096];
  for (ssize_t got = 0; (got = read(ends[0], part, sizeof part)) > 0;) said.append(part, static_cast<std::size_t>(got));
  close(ends[0]);
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  return said;
}

/// An NVRTC of CUDA 11.7 that makes of a text that text and the options, one a line; with -v it says what a kernel takes,
/// and of a text that begins with "wrong" that it is wrong; that of CUDA 99.7 says so of any. It makes no program of "refused",
/// has a word of one letter about "brief", and fails to tell the length of its words about "mute" and of the code of "empty".
const std::string compiler_text = R"(
#include <cstring>
#include <string>
struct Program { std::string text, log, code; };
extern "C" {
int nvrtcVersion(int* major, int* minor) { *major = MAJOR, *minor = 7; return 0; }
int nvrtcCreateProgram(Program** p, const char* text, const char*, int, const char* const*, const char* const*) {
  if (!std::strcmp(text, "refused")) return 2;
  *p = new Program{text, "", ""};
  return 0;
}
int nvrtcCompileProgram(Program* p, int count, const char* const* options) {
  p->code = p->text;
  for (int k = 0; k < count; ++k) {
    p->code += std::string("\n") + options[k];
    if (!std::strcmp(options[k], "--ptxas-options=-v"))
      p->log = "ptxas info    : Compiling entry function 'mpm_move' for 'sm_90'\n"
               "    8 bytes stack frame, 4 bytes spill stores, 4 bytes spill loads\n"
               "ptxas info    : Used 64 registers, 1024 bytes smem\n"
               "ptxas info    : Compiling entry function 'mpm_clear' for 'sm_90'\n"
               "    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads\n"
               "ptxas info    : Used 32 registers\n";
  }
  if (p->text == "brief") p->log = "x";
  if (p->text == "mute") p->log = "words that nobody is told the length of";
  if (p->text.rfind("wrong", 0) != 0 && MAJOR < 99) return 0;
  p->log = "it is wrong";
  return 6;
}
int nvrtcGetProgramLogSize(Program* p, std::size_t* size) { *size = p->log.size() + 1; return p->text == "mute"; }
int nvrtcGetProgramLog(Program* p, char* log) { std::strcpy(log, p->log.c_str()); return 0; }
int CODE_SIZE(Program* p, std::size_t* size) { *size = p->code.size(); return p->text == "empty"; }
int nvrtcGetCUBIN(Program* p, char* code) { std::memcpy(code, p->code.data(), p->code.size()); return 0; }
int nvrtcDestroyProgram(Program** p) { delete *p; return 0; }
const char* nvrtcGetErrorString(int error) {
  return error == 6 ? "NVRTC_ERROR_COMPILATION" : error == 2 ? "NVRTC_ERROR_PROGRAM_CREATION_FAILURE" : "another";
}
}
)";

fs::path compiler_in(const fs::path& folder, int major = 11, const std::string& code_size = "nvrtcGetCUBINSize") {
  return library_of(folder / "libnvrtc.so", "#define MAJOR " + std::to_string(major) + "\n#define CODE_SIZE " +
                                                code_size + "\n" + compiler_text);
}

/// A driver with a device of 80 GiB and capability 9.0; what it is not asked for here says so. It begins with a result that
/// has this name and text.
fs::path driver_in(const fs::path& folder, int begins_with = 0, const std::string& name = "\"CUDA_ERROR_UNKNOWN\"",
                   const std::string& words = "\"an unknown error\"") {
  std::string text =
      "#define RESULT " + std::to_string(begins_with) + "\n#define NAME " + name + "\n#define TEXT " + words + R"(
#include <cstring>
extern "C" {
int cuInit(unsigned) { return RESULT; }
int cuDeviceGetCount(int* count) { *count = 1; return 0; }
int cuDeviceGet(int* device, int ordinal) { *device = 40 + ordinal; return 0; }
int cuDeviceGetName(char* name, int, int device) { std::strcpy(name, device == 40 ? "a GPU" : "another"); return 0; }
int cuDeviceTotalMem_v2(unsigned long* bytes, int) { *bytes = 80ul << 30; return 0; }
int cuDeviceGetAttribute(int* value, int attribute, int) { *value = attribute == 75 ? 9 : 0; return 0; }
int cuGetErrorName(int, const char** s) { *s = NAME; return 0; }
int cuGetErrorString(int, const char** s) { *s = TEXT; return 0; }
)";
#define MPM_STUB(name, parameters) \
  if (text.find("int " #name "(") == text.npos) text += "int " #name "() { return 999; }\n";
  MPM_DRIVER_FUNCTIONS(MPM_STUB)
#undef MPM_STUB
  return library_of(folder / "libcuda.so.1", text + "}");
}

/// Whether another test of this process has found an NVRTC, which then stays; says what is skipped for it.
bool has_compiler_already() {
  const bool there = dlopen("libnvrtc.so", RTLD_NOW | RTLD_NOLOAD) != nullptr;
  if (there) WARN("skipped: an NVRTC was loaded before");
  return there;
}

/// What every message says in the end that the device backend cannot begin with.
const std::string to_use_instead = "use --backend cpu, or --device host to run the device's kernels on the processor";

/// Why no driver can be used, in words; empty where one can.
std::string why_no_driver() {
  std::string why;
  return device::cuda_driver(why) ? std::string() : why;
}

/// Why no NVRTC is found on this machine; empty where there is one.
std::string missing_compiler() {
  return in_process_with({}, [] {
    std::string why;
    return device::Nvrtc::find(why) ? std::string() : why;
  });
}

}  // namespace

TEST_CASE("numbers that a driver is told and gives are those of cuda.h", "[device][libraries]") {
  // CUDA Driver API 12: CUresult, CUdevice_attribute, CUstreamCaptureMode, CU_LAUNCH_PARAM_*.
  const std::vector<int> found{device::driver_success,
                               device::driver_invalid_value,
                               device::driver_out_of_memory,
                               device::driver_not_initialized,
                               device::driver_device_unavailable,
                               device::driver_no_device,
                               device::driver_invalid_device,
                               device::driver_invalid_image,
                               device::driver_invalid_context,
                               device::driver_no_binary_for_device,
                               device::driver_unsupported_ptx_version,
                               device::driver_invalid_handle,
                               device::driver_illegal_state,
                               device::driver_not_found,
                               device::driver_not_ready,
                               device::driver_illegal_address,
                               device::driver_launch_out_of_resources,
                               device::driver_launch_failed,
                               device::driver_system_driver_mismatch,
                               device::driver_capture_unsupported,
                               device::driver_capture_invalidated};
  CHECK(found == std::vector<int>{0,   1,   2,   3,   46,  100, 101, 200, 201, 209, 222,
                                  400, 401, 500, 600, 700, 701, 719, 803, 900, 901});
  CHECK(device::capture_of_thread == 1);
  CHECK(device::attribute_most_shared_memory == 8);
  CHECK(device::attribute_multiprocessors == 16);
  CHECK(device::attribute_capability_major == 75);
  CHECK(device::attribute_capability_minor == 76);
  const auto number = [](void* key) { return reinterpret_cast<std::uintptr_t>(key); };
  CHECK(number(device::launch_parameter_end) == 0);
  CHECK(number(device::launch_parameter_buffer) == 1);
  CHECK(number(device::launch_parameter_size) == 2);
}

TEST_CASE("the devices of a machine are listed with its compilers", "[device][libraries]") {
  if (has_compiler_already()) return;
  const TemporaryFolder folder;
  const fs::path driver = driver_in(folder / "driver"), compiler = compiler_in(folder / "compiler");
  const auto list = [] {
    device::set_host_devices({{"the host", 3ull << 29, 0}});
    return device::device_list();
  };
  const std::string host = "host: the host, 1.5 GiB, this processor: the device's kernels, compiled by c++\n";
  CHECK(in_process_with({driver, compiler}, list) ==
        "0: a GPU, 80 GiB, sm_90\ncompiler: NVRTC 11.7 (libnvrtc.so)\n" + host);
  if (const std::string absent = in_process_with({}, why_no_driver); !absent.empty()) {
    CHECK(in_process_with({compiler}, list) ==
          "no device of CUDA: " + absent + "\ncompiler: NVRTC 11.7 (libnvrtc.so)\n" + host);
  }
  if (const std::string missing = missing_compiler(); !missing.empty())
    CHECK(in_process_with({driver}, list) == "0: a GPU, 80 GiB, sm_90\nno compiler of CUDA: " + missing + "\n" + host);
  const fs::path old = compiler_in(folder / "old", 11, "nvrtcGetCodeSize");
  CHECK(in_process_with({driver, old}, list) ==
        "0: a GPU, 80 GiB, sm_90\nno compiler of CUDA: libnvrtc.so is not an NVRTC of CUDA 11.2 or newer; install a "
        "newer CUDA toolkit\n" +
            host);
}

TEST_CASE("a driver that cannot be used is said with what it lacks and what to do", "[device][libraries]") {
  const TemporaryFolder folder;
  const fs::path old = library_of(folder / "old/libcuda.so.1", "extern \"C\" int cuInit(unsigned) { return 0; }");
  CHECK(in_process_with({old}, why_no_driver) ==
        "the NVIDIA driver on this machine (libcuda) has no function cuDriverGetVersion: it is older than CUDA 11.4; "
        "install a newer driver; " +
            to_use_instead);
  const auto without_device = [&](const std::string& name, const std::string& words) {
    return in_process_with({driver_in(folder / "driver", 100, name, words)}, why_no_driver);
  };
  const std::string begin = "the NVIDIA driver (libcuda) finds no device that it can use: ",
                    end =
                        "; see whether nvidia-smi lists a device and CUDA_VISIBLE_DEVICES names it; " + to_use_instead;
  CHECK(without_device("\"CUDA_ERROR_NO_DEVICE\"", "\"none is there\"") ==
        begin + "CUDA_ERROR_NO_DEVICE, none is there" + end);
  CHECK(without_device("nullptr", "nullptr") == begin + "100" + end);
  const std::string absent = in_process_with({}, why_no_driver);
  if (!absent.starts_with("backend")) {
    WARN("the rest is skipped: this machine has a driver");
    return;
  }
  CHECK(absent ==
        "backend \"cuda\" needs NVIDIA's driver: no libcuda.so.1 or libcuda.so on the loader's path (LD_LIBRARY_PATH, "
        "/etc/ld.so.conf); install the driver of the device; " +
            to_use_instead);
}

TEST_CASE("an NVRTC that is not there is said with where it was looked for", "[device][libraries]") {
  if (missing_compiler().empty()) {
    WARN("skipped: this machine has an NVRTC");
    return;
  }
  const TemporaryFolder folder;
  const fs::path driver = driver_in(folder / "driver");
  const auto said = [&](const char* path, const char* home) {
    return in_process_with({driver}, [&]() -> std::string {
      setenv("CUDA_PATH", path, 1), setenv("CUDA_HOME", home, 1);
      return device::setup_for("0").driver ? "there" : "";
    });
  };
  const std::string begin =
      "threw backend \"cuda\" compiles its kernels for the scene, and NVRTC was not found: no libnvrtc.so, .so.13, "
      ".so.12 "
      "or .so.11.2 on the loader's path";
  const std::string end =
      " or in /usr/local/cuda/lib64/; install the CUDA toolkit or set CUDA_PATH to its folder; or " + to_use_instead;
  CHECK(said("/no/path", "/no/home") == begin + " or in /no/path/lib64/ or in /no/home/lib64/" + end);
  CHECK(said("/no/path", "/no/path") == begin + " or in /no/path/lib64/" + end);  // once
  CHECK(said("", "") == begin + end);
}

TEST_CASE("what NVRTC says of a text is kept to the letter, and what it fails to say is not", "[device][libraries]") {
  if (has_compiler_already()) return;
  const TemporaryFolder folder;
  const fs::path compiler = compiler_in(folder / "compiler");
  const auto made = [&](const std::string& text) {
    return in_process_with({compiler}, [&] {
      std::string why;
      const device::Cubin cubin = device::Nvrtc::find(why)->compile({"a scene", text, "", {}, {}}, "sm_90");
      return std::string(cubin.compiled ? "compiled" : "not compiled") + ", \"" + cubin.log + "\", " +
             cubin.code.substr(0, text.size());
    });
  };
  CHECK(made("good") == "compiled, \"\", good");
  CHECK(made("brief") == "compiled, \"x\", brief");
  CHECK(made("mute") == "compiled, \"\", mute");
  CHECK(made("empty") == "not compiled, \"\", ");
  CHECK(made("wrong") == "not compiled, \"a scene: NVRTC_ERROR_COMPILATION\nit is wrong\", ");
  CHECK(made("refused") == "not compiled, \"nvrtcCreateProgram: NVRTC_ERROR_PROGRAM_CREATION_FAILURE\", ");
}

TEST_CASE("a device of CUDA runs what NVRTC makes, which is kept by all that it depends on", "[device][libraries]") {
  if (has_compiler_already()) return;
  const TemporaryFolder folder;
  const fs::path driver = driver_in(folder / "driver"), compiler = compiler_in(folder / "compiler");
  const device::Composition good{"a scene", "a text", "its hash", {}, {}}, bad{"a bad one", "wrong", "another", {}, {}};
  const std::string options = "\n--gpu-architecture=sm_90\n-std=c++17\n-default-device\n-DMPM_DEVICE_PASS=1";
  const auto made = [&](const device::Composition& composition, const std::string& word) {
    return in_process_with({driver, compiler}, [&] {
      setenv("MPM_CACHE", (folder / "cache").c_str(), 1);
      const device::DeviceSetup setup = device::setup_for(word);
      return std::to_string(setup.number) + ", " + std::to_string(setup.lanes == device::lanes_of_gpu) + ": " +
             setup.compile(composition, "sm_90");
    });
  };
  CHECK(made(good, "0") == "0, 1: a text" + options);
  CHECK(made(good, "17") == "17, 1: a text" + options);
  const std::string key = device::cache_key(good, "NVRTC 11.7 (libnvrtc.so)" + options, {"sm_90"});
  CHECK(device::ProgramCache(folder / "cache", 1 << 20).find(key) == "a text" + options);
  CHECK(made(bad, "0") ==
        "threw NVRTC 11.7 (libnvrtc.so) does not compile the composition a bad one for sm_90:\n"
        "a bad one: NVRTC_ERROR_COMPILATION\nit is wrong");
}

TEST_CASE("a plan has what ptxas says of kernels in the order of the source", "[device][libraries]") {
  if (has_compiler_already()) return;
  const TemporaryFolder folder;
  const fs::path compiler = compiler_in(folder / "compiler");
  const std::string said = in_process_with({compiler}, [&] {
    setenv("MPM_CACHE", (folder / "cache").c_str(), 1);
    const Experiment experiment = device_experiment(Mix{}.text(), "double");
    return device::device_plan(experiment, make_plan(experiment), device::multiprocessor("sm_90")).to_text();
  });
  INFO(said);
  const std::size_t at =
      said.find(", as NVRTC 11.7 compiles them for sm_90 (nothing was run), with 128 lanes a team\n");
  REQUIRE(at != said.npos);
  CHECK(said.find("    stress                              4     32 B   within a step\n") != said.npos);
  const Experiment experiment = device_experiment(Mix{}.text(), "double");
  const device::Composition composition = device::compose(device_choice_of(experiment));
  const std::string key = device::cache_key(composition, "NVRTC 11.7 (libnvrtc.so), resources", {"sm_90"});
  CHECK(device::ProgramCache(folder / "cache", 1 << 20).find(key));
  const fs::path other = compiler_in(folder / "other", 99);
  CHECK(in_process_with(
            {other},
            [&] {
              setenv("MPM_CACHE", (folder / "cache").c_str(), 1);
              return device::device_plan(experiment, make_plan(experiment), device::multiprocessor("sm_90")).to_text();
            }) ==
        "threw NVRTC 99.7 (libnvrtc.so) does not compile the composition 2-D double: bspline_quadratic apic "
        "neo_hookean for sm_90:\n2-D double: bspline_quadratic apic neo_hookean: NVRTC_ERROR_COMPILATION\nit is wrong");
  CHECK(said.substr(said.find('\n', at) + 1) ==
        "    kernel                           registers   shared   stack spilled  occupancy\n"
        "    clear                                   32      0 B     0 B     0 B      100 %\n"
        "    move                                    64   1024 B     8 B     8 B       50 %\n");
}

TEST_CASE("a plan without a compiler has the memory and says what is missing", "[device][libraries]") {
  device::DevicePlan plan;
  plan.composition = "2-D double: a scene", plan.bodies = {"block", "ball"};
  plan.memory = {{"position", 0, 2, 16, false},
                 {"stress", 0, 4, 32, true},
                 {"position", 1, 2, 16, false},
                 {"mass", device::TakenMemory::of_nodes, 1, 24, true}};
  plan.kernels = {"clear", "move"}, plan.missing = "there is none";
  CHECK(plan.to_text() ==
        "On a device: 2-D double: a scene\n"
        "  body 0, block: 48 bytes a particle\n"
        "    position                            2     16 B\n"
        "    stress                              4     32 B   within a step\n"
        "  body 1, ball: 16 bytes a particle\n"
        "    position                            2     16 B\n"
        "  24 bytes a node, with all velocity fields\n"
        "    mass                                1     24 B   within a step\n"
        "  2 kernels; what they take is not known: there is none\n");
  const nlohmann::ordered_json json = plan.to_json();
  CHECK(json["missing"] == "there is none");
  CHECK(json["bodies"][1] == nlohmann::ordered_json{{"name", "ball"}, {"bytes_per_particle", 16}});
  CHECK(json["memory"][3]["body"].is_null());
  CHECK(json["kernel_count"] == 2);
  CHECK_FALSE(json.contains("looks_at_particles"));
}

TEST_CASE("the plan of a device says who asks nodes to look at particles", "[device][libraries]") {
  Mix mix;
  const auto who = [&](const std::string& contact) {
    mix.contact = contact;
    return device::who_looks_at_particles(device_experiment(mix.text(), "double"));
  };
  CHECK(who(R"({"type": "coulomb"})").empty());
  CHECK(who(R"({"type": "stick"})").empty());
  const std::string normal = "/contact/normal \"widest_gap\"", detection = "/contact/detection \"particle_surfaces\"";
  CHECK(who(R"({"type": "coulomb", "normal": "widest_gap"})") == normal);
  CHECK(who(R"({"type": "coulomb", "detection": "particle_surfaces"})") == detection);
  device::DevicePlan plan;
  plan.looks = who(R"({"type": "coulomb", "normal": "widest_gap", "detection": "particle_surfaces"})");
  CHECK(plan.looks == normal + ", " + detection);
  plan.missing = "there is none";
  CHECK_THAT(plan.to_text(), ContainsSubstring("\n  " + plan.looks +
                                               ": nodes where fields meet look at particles, once a step "
                                               "(find_meeting_nodes, look_at_particles)\n"));
  CHECK(plan.to_json()["looks_at_particles"] == plan.looks);
}

TEST_CASE("CUDA_PATH is looked at before CUDA_HOME, and both before the usual folder", "[device][libraries]") {
  // What the loader finds comes first: none of the usual names may be there.
  for (const char* name : {"libnvrtc.so", "libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so.11.2"})
    if (in_process_with({}, [&] { return std::string(dlopen(name, RTLD_NOW) ? "there" : ""); }) == "there") {
      WARN("skipped: the loader's path has an NVRTC");
      return;
    }
  const TemporaryFolder folder;
  compiler_in(folder / "z/lib64", 98), compiler_in(folder / "a/lib64", 97);
  const auto version = [&](const std::string& path, const std::string& home) {
    return in_process_with({}, [&] {
      setenv("CUDA_PATH", (folder / path).c_str(), 1), setenv("CUDA_HOME", (folder / home).c_str(), 1);
      std::string why;
      const std::optional<device::Nvrtc> found = device::Nvrtc::find(why);
      return found ? found->version() : why;
    });
  };
  const auto expected = [&](int major, const std::string& name) {
    return std::to_string(major) + ".7 (" + (folder / name).string() + "/lib64/libnvrtc.so)";
  };
  CHECK(version("z", "a") == expected(98, "z"));
  CHECK(version("a", "z") == expected(97, "a"));
  CHECK(version("nowhere", "z") == expected(98, "z"));
}

TEST_CASE("a word names the host, or a device by its number", "[device][libraries]") {
  for (const std::string word : {"host", "0", "7", "1234"}) CHECK(device::names_device(word));
  for (const std::string word : {"", "12345", "1a", "-1", "hosts", "gpu"}) CHECK(!device::names_device(word));
  CHECK(device::is_host_device("host"));
  CHECK(!device::is_host_device("0"));
  CHECK(!device::is_host_device(""));
  setenv("MPM_DEVICE", "host", 1);
  CHECK(device::is_host_device(""));
  CHECK(!device::is_host_device("0"));
  CHECK(device::setup_for("").driver == &device::host_driver());
  setenv("MPM_DEVICE", "gpu", 1);
  CHECK_THROWS_WITH(device::setup_for(""),
                    ContainsSubstring("MPM_DEVICE: expected \"host\" or the number of a device"));
  setenv("MPM_DEVICE", "", 1);  // as if it were not there
  CHECK(!device::is_host_device(""));
  unsetenv("MPM_DEVICE");
  CHECK_THROWS_WITH(device::setup_for("gpu"),
                    "--device: expected \"host\" or the number of a device, got \"gpu\"; see mpm list --devices");
  CHECK(device::setup_for("host").driver == &device::host_driver());
}
