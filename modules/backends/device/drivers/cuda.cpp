#include "backends/device/drivers/cuda.hpp"

#include <dlfcn.h>

#include <mutex>

namespace mpm::device {
namespace {

struct Found {
  Driver driver;
  bool usable = false;
  std::string why;
};

constexpr const char* instead = "; use --backend cpu, or --device host to run the device's kernels on the processor";

Found find() {
  Found found;
  const char* const names[] = {"libcuda.so.1", "libcuda.so"};
  void* library = nullptr;
  for (const char* name : names)
    if (!library) library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    found.why = std::string(
                    "backend \"cuda\" needs NVIDIA's driver: no libcuda.so.1 or libcuda.so on the loader's path "
                    "(LD_LIBRARY_PATH, /etc/ld.so.conf); install the driver of the device") +
                instead;
    return found;
  }
#define MPM_LOAD(name, parameters)                                                     \
  found.driver.name = reinterpret_cast<decltype(Driver::name)>(dlsym(library, #name)); \
  if (!found.driver.name && found.why.empty()) found.why = #name;
  MPM_DRIVER_FUNCTIONS(MPM_LOAD)
#undef MPM_LOAD
  if (!found.why.empty()) {
    found.why = "the NVIDIA driver on this machine (libcuda) has no function " + found.why +
                ": it is older than CUDA 11.4; install a newer driver" + instead;
    return found;
  }
  if (const DriverResult result = found.driver.cuInit(0); result != driver_success) {
    const char *name = nullptr, *text = nullptr;
    found.driver.cuGetErrorName(result, &name), found.driver.cuGetErrorString(result, &text);
    found.why = std::string("the NVIDIA driver (libcuda) finds no device that it can use: ") +
                (name ? name : std::to_string(result).c_str()) + (text ? std::string(", ") + text : "") +
                "; see whether nvidia-smi lists a device and CUDA_VISIBLE_DEVICES names it" + instead;
    return found;
  }
  found.usable = true;
  return found;
}

}  // namespace

const Driver* cuda_driver(std::string& why) {
  static const Found found = find();  // the library stays loaded: it keeps threads and memory of its own
  why = found.why;
  return found.usable ? &found.driver : nullptr;
}

}  // namespace mpm::device
